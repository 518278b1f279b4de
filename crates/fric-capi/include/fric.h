/* fric: friction compensation for cable robots, the interface in C.
 *
 * Made by cbindgen from crates/fric-capi; do not edit. SI units, in the names. SPDX-License-Identifier: MIT OR Apache-2.0 */

#ifndef FRIC_H
#define FRIC_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// Version of this interface. It grows whenever a structure or the meaning of a function changes; compare it with
/// fric_abi_version() once at start-up.
#define FRIC_ABI_VERSION 1

/// Nothing is the matter.
#define FRIC_STATUS_OK 0

/// The cable carries no tension.
#define FRIC_STATUS_SLACK 1

/// The cable slips on a pulley.
#define FRIC_STATUS_SLIP 2

/// The sensor force is NaN, infinite or beyond 1e9 N: last good force and friction are held.
#define FRIC_STATUS_SENSOR_NOT_FINITE 4

/// The sensor repeats itself to the last bit while the cable moves: last good force and friction are held.
#define FRIC_STATUS_SENSOR_FROZEN 8

/// The length changed by more than `length_jump_m` of the robot file: the friction is held.
#define FRIC_STATUS_LENGTH_JUMP 16

/// Length or speed is NaN, infinite or beyond 1e6: the friction is held.
#define FRIC_STATUS_MOTION_NOT_FINITE 32

/// Outside the range in which the parameters were identified; computed as usual.
#define FRIC_STATUS_OUT_OF_RANGE 64

/// No usable pose for a cable that needs it: last wrap and direction are held.
#define FRIC_STATUS_POSE_MISSING 128

/// The pose leaves the cable no way out of its last pulley: last wrap and direction are held.
#define FRIC_STATUS_POSE_UNREACHABLE 256

/// The sensor force has jumped by more than the cable can do, and not yet back; computed as usual.
#define FRIC_STATUS_SENSOR_JUMP 512

/// The stored friction is beyond what the load bears by more than 25 % of the tension + 0.1 N, or a jump of the sensor may have left an error of 5 % + 0.1 N.
#define FRIC_STATUS_UNSETTLED 1024

/// Outcome of a call. Anything but FRIC_RESULT_OK has left the compensator, and the output of a step, as they were.
typedef enum fric_result {
  /// Done.
  FRIC_RESULT_OK = 0,
  /// A pointer is null, or not aligned for what it points to.
  FRIC_RESULT_BAD_POINTER = 1,
  /// `struct_size` is not that of this ABI version, or `cable_count` is not the robot's.
  FRIC_RESULT_WRONG_SIZE = 2,
  /// The robot file cannot be read, or something in it is wrong; the error text says what, where and what is allowed.
  FRIC_RESULT_ROBOT_FILE = 3,
  /// The change of parameters given before is not over; try again some steps later.
  FRIC_RESULT_BUSY = 4,
  /// A mistake inside of the library, caught; please report it.
  FRIC_RESULT_INTERNAL = 5,
} fric_result;

/// Friction compensation of one robot: made by fric_load_file or fric_load_text, given back by fric_free.
///
/// One thread at a time may step or reset it. Others may ask for names and numbers and change parameters meanwhile. Several
/// compensators are independent of each other.
typedef struct fric_compensator fric_compensator;

/// Signals of one cable.
typedef struct fric_cable_input {
  /// Force that the sensor shows, N.
  double sensor_force_n;
  /// Cable length, m; any zero, only changes count. Positive paying out. The winch's set point, or a measured length of
  /// little noise.
  double length_m;
  /// Its rate, m/s.
  double speed_m_per_s;
} fric_cable_input;

/// Pose of the platform in the base frame.
typedef struct fric_pose {
  /// Platform origin, m.
  double position_m[3];
  /// Rotation from platform to base axes as a quaternion x, y, z, w; normalised here. One whose norm is not within 10 % of 1
  /// is no pose.
  double orientation_xyzw[4];
} fric_pose;

/// Signals of one cycle.
typedef struct fric_input {
  /// sizeof(fric_input).
  size_t struct_size;
  /// Cables in the robot's order.
  const struct fric_cable_input *cables;
  /// How many; the robot's, fric_cable_count.
  size_t cable_count;
  /// Pose of the platform; null where it is not known.
  const struct fric_pose *pose;
  /// Cycles since the last step, 1 unless some were skipped: a longer pause allows a longer way before a change of length
  /// counts as a jump. Less than 1 (0, as in a zeroed structure) and NaN count as 1.
  double elapsed_cycles;
} fric_input;

/// Outcome for one cable. All numbers are finite, whatever went in.
typedef struct fric_cable_output {
  /// Cable force at the platform, N, the offset included.
  double force_at_platform_n;
  /// Estimated friction, N; positive where it makes the platform side tighter.
  double friction_n;
  /// The sensor force turned into cable tension as if nothing rubbed, N.
  double frictionless_n;
  /// FRIC_STATUS_… flags, FRIC_STATUS_OK if nothing is the matter.
  uint32_t status;
} fric_cable_output;

/// Force and torque in base axes, torque about the platform origin.
typedef struct fric_wrench {
  /// Force, N.
  double force_n[3];
  /// Torque, N m.
  double torque_nm[3];
} fric_wrench;

/// Outcome of one cycle. Set `struct_size`, `cables` and `cable_count`; the step sets the rest.
typedef struct fric_output {
  /// sizeof(fric_output).
  size_t struct_size;
  /// Where the outcome for the cables goes, in the robot's order.
  struct fric_cable_output *cables;
  /// How many; the robot's, fric_cable_count.
  size_t cable_count;
  /// What acts on the platform from outside, gravity included; zero without a wrench.
  struct fric_wrench outside_wrench;
  /// The same less gravity: what a hand, a tool or acceleration applies; zero without a wrench.
  struct fric_wrench applied_wrench;
  /// Whether there are wrenches: not before the first pose, and not for a robot file that lacks the attachment of a cable.
  bool has_wrench;
  /// Every FRIC_STATUS_… flag of any cable that the wrenches are made of.
  uint32_t wrench_status;
} fric_output;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/// Changes to the parameters of another robot file while a thread steps: without stopping it, without a lock in the step, and without a
/// jump in the output.
///
/// The steps after it take the parameters over: within `blend_s` seconds (0…3600; one cycle at least) the output goes over from
/// the old parameters to the new ones, and a step takes twice as long, the first up to six times. The file is that of the same robot: friction,
/// effects, wraps, geometry, masses and limits may differ; cycle time, the cables' names and order, how many pulleys each
/// has, which of them follow the pose, and which cables have an attachment may not. One change at a time:
/// FRIC_RESULT_BUSY until the first step after the blend of the change before. FRIC_RESULT_ROBOT_FILE also where the file is that
/// of another robot, or `blend_s` out of its range or NaN. `error` is as in fric_load_file. Not for the cycle: it reads a file
/// and allocates.
///
/// # Safety
/// `compensator` is null or a compensator that has not been given back and is not while this runs; `path` is null or a
/// string that ends with zero; `error` is null or `error_size` bytes may be written to there.
enum fric_result fric_change_file(const struct fric_compensator *compensator,
                                  const char *path,
                                  double blend_s,
                                  char *error,
                                  size_t error_size);

/// The same with the text of a robot file.
///
/// # Safety
/// `toml` is null or a string that ends with zero; the rest as for fric_change_file.
enum fric_result fric_change_text(const struct fric_compensator *compensator,
                                  const char *toml,
                                  double blend_s,
                                  char *error,
                                  size_t error_size);

/// One cycle: for the inside of the control loop. It does not allocate, lock or wait, and takes any numbers, NaN
/// included.
///
/// On anything but FRIC_RESULT_OK nothing has happened and the output is as it was. Input and output may share no memory.
///
/// # Safety
/// `compensator` is null or a compensator that has not been given back and that nobody else steps or resets now. `input`
/// and `output` are null or structures whose `struct_size` can be read; if that is right, the rest can be too, and
/// `cables` are null or as many as `cable_count` says, `pose` null or a pose, those of the output writable.
enum fric_result fric_step(struct fric_compensator *compensator,
                           const struct fric_input *input,
                           struct fric_output *output);

/// Back to the state after set-up: at rest, nothing stored, no pose. The parameters stay; those of a change that has been given
/// hold at once, without a blend. It does not allocate, lock or wait.
///
/// # Safety
/// `compensator` is null or a compensator that has not been given back and that nobody else steps or resets now.
enum fric_result fric_reset(struct fric_compensator *compensator);

/// How many cables the robot has; 0 for a null pointer.
///
/// # Safety
/// `compensator` is null or a compensator that has not been given back.
size_t fric_cable_count(const struct fric_compensator *compensator);

/// Cycle time of the robot, s; 0 for a null pointer.
///
/// # Safety
/// `compensator` is null or a compensator that has not been given back.
double fric_cycle_s(const struct fric_compensator *compensator);

/// Name of the robot in UTF-8; null for a null pointer. The text lives until fric_free.
///
/// # Safety
/// `compensator` is null or a compensator that has not been given back.
const char *fric_robot_name(const struct fric_compensator *compensator);

/// Name of a cable, counted from 0, in UTF-8; null for a null pointer or a cable that the robot does not have. The text
/// lives until fric_free.
///
/// # Safety
/// `compensator` is null or a compensator that has not been given back.
const char *fric_cable_name(const struct fric_compensator *compensator,
                            size_t cable);

/// Gives a compensator back. Null does nothing. Not for the cycle: it frees memory.
///
/// # Safety
/// `compensator` is null or a compensator that has not been given back; it is not used afterwards.
void fric_free(struct fric_compensator *compensator);

/// Makes a compensator for the robot of a robot file (TOML, `format = "fric-robot/1"`).
///
/// `path` is UTF-8. On FRIC_RESULT_OK `*compensator` is the new compensator, else null. `error` takes one sentence that
/// says what is wrong, where and what is allowed, cut to `error_size` bytes with the final zero, and is empty without
/// an error; it may be null with size 0. Not for the cycle: it reads a file and allocates. The optimised library takes
/// at most 1024 KiB of stack, 256 KiB for a robot of 16 cables or fewer; so do fric_load_text, fric_change_file and fric_change_text.
///
/// # Safety
/// `path` is null or a string that ends with zero; `compensator` is null or may be written to; `error` is null or
/// `error_size` bytes may be written to there.
enum fric_result fric_load_file(const char *path,
                                struct fric_compensator **compensator,
                                char *error,
                                size_t error_size);

/// The same for the text of a robot file, which has no place of its own: errors name line and key.
///
/// # Safety
/// `toml` is null or a string that ends with zero; the rest as for fric_load_file.
enum fric_result fric_load_text(const char *toml,
                                struct fric_compensator **compensator,
                                char *error,
                                size_t error_size);

/// Version of the interface that this library has; FRIC_ABI_VERSION of the header that it goes with.
uint32_t fric_abi_version(void);

/// Version of the library, "0.1.0"; the text lives as long as the program.
const char *fric_version(void);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* FRIC_H */
