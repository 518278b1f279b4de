/* fric: friction compensation for cable robots, the interface in C.
 *
 * Made by cbindgen from crates/fric-capi; do not edit. SI units, in the names.
 *
 * A cable robot: fric_load_file at set-up, fric_step in each cycle, fric_free at the end. A continuum manipulator:
 * fric_static_model_load_file, fric_static_model_tension_for and fric_static_model_solve, fric_static_model_free.
 * What stands under "Safety" the caller has to ensure; everything else is checked and gives a code.
 *
 * SPDX-License-Identifier: MIT OR Apache-2.0 */

#ifndef FRIC_H
#define FRIC_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/// Version of this interface. It grows whenever a structure or the meaning of a function changes; compare it with
/// fric_abi_version() once at start-up.
#define FRIC_ABI_VERSION 1

/// The goal is a bend of the whole manipulator.
#define FRIC_GOAL_BEND 0

/// The goal is a position of the tip, the centre of the last disk.
#define FRIC_GOAL_TIP 1

/// Friction from each hole's memory of the history of the tensions at the base.
#define FRIC_FRICTION_HISTORY 0

/// No friction.
#define FRIC_FRICTION_NONE 1

/// Coulomb friction with every hole sliding as in pulling: the first tendon is pulled, the second pays out.
#define FRIC_FRICTION_PULLING 2

/// Coulomb friction with every hole sliding in the opposite direction.
#define FRIC_FRICTION_RELEASING 3

/// Friction from the tensions measured in the segments.
#define FRIC_FRICTION_MEASURED 4

/// The shape has no fault.
#define FRIC_SHAPE_OK 0

/// A tension is negative, NaN, infinite or beyond 1e9 N: the shape and the memory of the holes are unchanged.
#define FRIC_SHAPE_NOT_FINITE 1

/// No equilibrium was found: the shape and the memory of the holes are unchanged.
#define FRIC_SHAPE_NOT_CONVERGED 2

/// The equilibrium is unstable, and the manipulator would leave it: the shape and the memory of the holes are unchanged.
#define FRIC_SHAPE_UNSTABLE 4

/// A tension exceeds the tendon's capacity; computed as usual.
#define FRIC_SHAPE_OVER_CAPACITY 8

/// Disks would touch, and the bend is beyond the model; computed as usual.
#define FRIC_SHAPE_DISKS_TOUCH 16

/// A hole has not slid since `StaticModel::begin_history` of the Rust crate stated what it holds; computed as usual.
#define FRIC_SHAPE_MEMORY_UNCERTAIN 32

/// The flags without a new shape.
#define FRIC_SHAPE_FAILED 7

/// The command reaches the goal, and the manipulator continues in its previous direction.
#define FRIC_COMMAND_OK 0

/// The goal is not finite, or the friction is FRIC_FRICTION_MEASURED: the tensions are unchanged.
#define FRIC_COMMAND_NOT_USABLE 1

/// No tension was found: the tensions are unchanged.
#define FRIC_COMMAND_NOT_CONVERGED 2

/// The tensions of the drive end before the goal, disks would touch, there is no stable shape, or the tip passes the goal by more than 1 % of the
/// manipulator's length: the command is the nearest possible one.
#define FRIC_COMMAND_OUT_OF_REACH 4

/// The goal is nearer than `hold_rad` of the drive: the tensions are unchanged.
#define FRIC_COMMAND_HELD 8

/// The tendon reverses: friction at the base plate was against this motion before. The goal is reached.
#define FRIC_COMMAND_REVERSAL 16

/// Some hole still has the friction of the previous motion, so the tip hardly moves until the tension has changed by the dead band. The goal is reached.
#define FRIC_COMMAND_DEAD_BAND 32

/// The flags with which the command does not reach the goal.
#define FRIC_COMMAND_MISSED 7

/// Bytes that hold every text of fric_status_text, including the final zero.
#define FRIC_TEXT_SIZE 256

/// No fault.
#define FRIC_STATUS_OK 0

/// The cable carries no tension.
#define FRIC_STATUS_SLACK 1

/// The cable slips on a pulley.
#define FRIC_STATUS_SLIP 2

/// The sensor force is NaN, infinite or beyond 1e9 N: the last valid force and friction are held.
#define FRIC_STATUS_SENSOR_NOT_FINITE 4

/// The sensor repeats its value to the last bit for `frozen_cycles` of the robot file, in which the cable has moved by 1 mm or more: the last valid
/// force and friction are held. A quiet sensor with coarse steps needs more cycles there, or 0, which switches the check off.
#define FRIC_STATUS_SENSOR_FROZEN 8

/// The length changed by more than `length_jump_m` of the robot file per elapsed cycle: the friction is held.
#define FRIC_STATUS_LENGTH_JUMP 16

/// Length or speed is NaN, infinite or beyond 1e6: the friction is held.
#define FRIC_STATUS_MOTION_NOT_FINITE 32

/// The signals are outside the range in which the parameters were identified; computed as usual.
#define FRIC_STATUS_OUT_OF_RANGE 64

/// There is no usable pose for a cable that needs it: last wrap and direction are held.
#define FRIC_STATUS_POSE_MISSING 128

/// The pose leaves the cable no way out of its last pulley: last wrap and direction are held.
#define FRIC_STATUS_POSE_UNREACHABLE 256

/// The sensor force has jumped by more than the cable can change it, and has not yet returned; computed as usual.
#define FRIC_STATUS_SENSOR_JUMP 512

/// The stored friction exceeds what the load allows by more than 25 % of the tension + 0.1 N, or a jump of the sensor may have left an error of 5 % +
/// 0.1 N.
#define FRIC_STATUS_UNSETTLED 1024

/// Result of a call. Anything but FRIC_RESULT_OK has left the compensator or static model, and the output of a step, unchanged.
typedef enum fric_result {
  /// Success.
  FRIC_RESULT_OK = 0,
  /// A pointer is null, or misaligned for its type.
  FRIC_RESULT_BAD_POINTER = 1,
  /// `struct_size` is not that of this ABI version, `cable_count` is not the robot's, or a number of disks is not the manipulator's.
  FRIC_RESULT_WRONG_SIZE = 2,
  /// The robot or manipulator file cannot be read, or is invalid; the error text says what is wrong, where and what is allowed.
  FRIC_RESULT_ROBOT_FILE = 3,
  /// The previous change of parameters is not over; try again some steps later.
  FRIC_RESULT_BUSY = 4,
  /// A bug inside the library was caught; please report it.
  FRIC_RESULT_INTERNAL = 5,
  /// A `kind` or `friction` is none of this header's numbers for it, or a limit of the drives is out of its range.
  FRIC_RESULT_BAD_VALUE = 6,
} fric_result;

/// Friction compensation of one robot: created by fric_load_file or fric_load_text, freed by fric_free.
///
/// Only one thread at a time may step or reset it. Others may query names and numbers and change parameters meanwhile. Several compensators are
/// independent of each other.
typedef struct fric_compensator fric_compensator;

/// Static model of one continuum manipulator: created by fric_static_model_load_file or fric_static_model_load_text, freed by fric_static_model_free.
///
/// Tensions are those of the tendons at the base plate, and positions are in the base frame. The tables `[base_sensor]` and `[markers]` of the
/// manipulator file are not applied: a signal of such a sensor becomes a tension by (shown − offset_n)/gain. Only one thread at a time may use a
/// model. Others may query its name and its number of disks meanwhile. Several models are independent of each other.
typedef struct fric_static_model fric_static_model;

/// Signals of one cable.
typedef struct fric_cable_input {
  /// Force shown by the sensor, N.
  double sensor_force_n;
  /// Cable length, m, positive paying out; its zero is arbitrary, because only changes count. The winch's set point, or a measured length with
  /// little noise.
  double length_m;
  /// Rate of the length, m/s.
  double speed_m_per_s;
} fric_cable_input;

/// Pose of the platform in the base frame.
typedef struct fric_pose {
  /// Platform origin, m.
  double position_m[3];
  /// Rotation from platform to base axes as a quaternion x, y, z, w, which is normalised here. A quaternion whose norm is not within 10 % of 1 is
  /// no pose.
  double orientation_xyzw[4];
} fric_pose;

/// Signals of one cycle.
typedef struct fric_input {
  /// sizeof(fric_input).
  size_t struct_size;
  /// Cables in the robot's order.
  const struct fric_cable_input *cables;
  /// Number of cables, which must be fric_cable_count.
  size_t cable_count;
  /// Pose of the platform; null if it is unknown.
  const struct fric_pose *pose;
  /// Cycles since the last step, 1 unless some were skipped. A longer pause allows a longer distance before a change of length counts as a jump, and
  /// advances a change of parameters. The range is 1 to 1e6: lower values (0, as in a zeroed structure) and NaN count as 1. Higher ones, infinity
  /// included, count as 1e6 for what goes by time, but as 1 in the checks of jumps: after such a pause, a change that is too large for one cycle is
  /// flagged FRIC_STATUS_LENGTH_JUMP or FRIC_STATUS_SENSOR_JUMP.
  double elapsed_cycles;
} fric_input;

/// Output for one cable. All numbers are finite, whatever the input.
typedef struct fric_cable_output {
  /// Cable force at the platform including the offset, N.
  double force_at_platform_n;
  /// Estimated friction, N; positive if it makes the platform side tighter.
  double friction_n;
  /// Cable tension computed from the sensor force without friction, N.
  double frictionless_n;
  /// FRIC_STATUS_… flags, FRIC_STATUS_OK if there is no fault.
  uint32_t status;
} fric_cable_output;

/// Force and torque in base axes, torque about the platform origin.
typedef struct fric_wrench {
  /// Force, N.
  double force_n[3];
  /// Torque, N m.
  double torque_nm[3];
} fric_wrench;

/// Output of one cycle. Set `struct_size`, `cables` and `cable_count`; the step sets the rest.
typedef struct fric_output {
  /// sizeof(fric_output).
  size_t struct_size;
  /// Output for the cables, in the robot's order.
  struct fric_cable_output *cables;
  /// Number of cables, which must be fric_cable_count.
  size_t cable_count;
  /// External wrench on the platform including gravity; zero without a wrench.
  struct fric_wrench outside_wrench;
  /// External wrench without gravity: the contribution of a hand, a tool or acceleration; zero without a wrench.
  struct fric_wrench applied_wrench;
  /// Whether there are wrenches: not before the first pose, and not for a robot file that lacks the attachment of a cable.
  bool has_wrench;
  /// Every FRIC_STATUS_… flag of any cable that contributes to the wrenches.
  uint32_t wrench_status;
} fric_output;

/// The limits of the drives at the base.
typedef struct fric_drive {
  /// sizeof(fric_drive).
  size_t struct_size;
  /// Tension that each tendon keeps while the other one is pulled, N, at least 0.
  double least_tension_n[2];
  /// Greatest tension of each tendon, N, from the least tension up to the tendon's capacity. If it equals the least tension, that tendon is not
  /// pulled.
  double greatest_tension_n[2];
  /// A goal nearer than this, rad (for the tip: relative to the manipulator's length), keeps the tensions, so that noise on the goal does not move
  /// them back and forth across the friction of all holes. 0…1.
  double hold_rad;
} fric_drive;

/// The goal of the manipulator.
typedef struct fric_goal {
  /// sizeof(fric_goal).
  size_t struct_size;
  /// With FRIC_GOAL_BEND: the bend of the whole manipulator, rad, positive towards the first tendon.
  double bend_rad;
  /// With FRIC_GOAL_TIP: the centre of the last disk, base frame, m. One tension moves the tip along a curve; the command brings it to the nearest
  /// point of that curve.
  double tip_m[2];
  /// FRIC_GOAL_BEND or FRIC_GOAL_TIP.
  uint32_t kind;
  /// FRIC_FRICTION_…, except FRIC_FRICTION_MEASURED, which cannot predict other tensions. That of a zeroed structure is FRIC_FRICTION_HISTORY.
  uint32_t friction;
} fric_goal;

/// The tensions to set at the base, and the model's prediction. Set `struct_size`; the call sets the rest. All numbers are finite, whatever the
/// input.
typedef struct fric_command {
  /// sizeof(fric_command).
  size_t struct_size;
  /// Tension at the base of the first and the second tendon, N.
  double base_tension_n[2];
  /// Predicted bend of the whole manipulator, rad.
  double bend_rad;
  /// Predicted centre of the last disk, base frame, m.
  double tip_m[2];
  /// FRIC_COMMAND_… flags, FRIC_COMMAND_OK if there is none.
  uint32_t status;
} fric_command;

/// Tensions measured in the segment that ends in a disk.
typedef struct fric_disk_input {
  /// Tensions of the first and the second tendon, N; 0 for a slack one.
  double tension_n[2];
} fric_disk_input;

/// The tensions for which a shape is computed.
typedef struct fric_shape_input {
  /// sizeof(fric_shape_input).
  size_t struct_size;
  /// Tension at the base of the first and the second tendon, N; 0 for a slack tendon.
  double base_tension_n[2];
  /// With FRIC_FRICTION_MEASURED: the tensions in the segments, starting at the base; otherwise ignored.
  const struct fric_disk_input *measured;
  /// Number of these, which must be fric_static_model_disk_count. Ignored without them.
  size_t measured_count;
  /// FRIC_FRICTION_…; that of a zeroed structure is FRIC_FRICTION_HISTORY.
  uint32_t friction;
} fric_shape_input;

/// A disk, the segment that ends in it, and the hole at the beginning of that segment.
typedef struct fric_disk_output {
  /// Centre of the disk, base frame: x along the straight manipulator, y towards the first tendon, m.
  double position_m[2];
  /// Bend of the segment, rad, positive towards the first tendon.
  double bend_rad;
  /// Tension in the segment of the first and the second tendon, N.
  double tension_n[2];
  /// Friction of each tendon at the hole, N; positive if the base side is tighter.
  double friction_n[2];
  /// Greatest friction of each tendon at the hole, N.
  double bound_n[2];
} fric_disk_output;

/// A shape. Set `struct_size`, `disks` and `disk_count`; the solution sets the rest. All numbers are finite, whatever the input.
typedef struct fric_shape_output {
  /// sizeof(fric_shape_output).
  size_t struct_size;
  /// Disks, segments and holes, starting at the base.
  struct fric_disk_output *disks;
  /// Number of disks, which must be fric_static_model_disk_count.
  size_t disk_count;
  /// Bend of the whole manipulator, the direction of the last disk, rad.
  double bend_rad;
  /// FRIC_SHAPE_… flags, FRIC_SHAPE_OK if there is no fault. With one of FRIC_SHAPE_FAILED the shape is the last valid one, straight before the
  /// first.
  uint32_t status;
} fric_shape_output;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

/// Changes a compensator to the parameters of another robot file while a thread steps it: without stopping that thread, without a lock in the step,
/// and without a jump in the output.
///
/// The following steps take the parameters over: within `blend_s` seconds (0…3600; at least one cycle) the output blends from the old parameters to
/// the new ones, and a step takes twice as long, the first up to six times. Skipped cycles (`elapsed_cycles`) count in that time. The file must be
/// that of the same robot: friction, effects, wraps, geometry, masses and limits may differ; cycle time, the cables' names and order, their numbers of
/// pulleys, which pulleys follow the pose, and which cables have an attachment may not. One change at a time: FRIC_RESULT_BUSY until the first step after the blend of the previous change.
/// FRIC_RESULT_ROBOT_FILE also if the file is that of another robot, or `blend_s` is NaN or out of its range. `error` is as in fric_load_file. Not
/// for the cycle: it reads a file and allocates.
///
/// # Safety
/// `compensator` is null or a compensator that has not been freed and is not freed during the call; `path` is null or a zero-terminated string;
/// `error` is null or points to `error_size` writable bytes.
enum fric_result fric_change_file(const struct fric_compensator *compensator,
                                  const char *path,
                                  double blend_s,
                                  char *error,
                                  size_t error_size);

/// Does the same as fric_change_file with the text of a robot file.
///
/// # Safety
/// `toml` is null or a zero-terminated string; the rest as for fric_change_file.
enum fric_result fric_change_text(const struct fric_compensator *compensator,
                                  const char *toml,
                                  double blend_s,
                                  char *error,
                                  size_t error_size);

/// Runs one cycle, inside the control loop. It does not allocate, lock or wait, and accepts any numbers, including NaN.
///
/// On anything but FRIC_RESULT_OK nothing has happened and the output is unchanged. Input and output must not share memory.
///
/// # Safety
/// `compensator` is null or a compensator that has not been freed and that nobody else steps or resets now. `input` and `output` are null or
/// structures whose `struct_size` is readable; if that is right, the rest is readable too, `cables` are null or `cable_count` elements, `pose` is
/// null or a pose, and those of the output are writable.
enum fric_result fric_step(struct fric_compensator *compensator,
                           const struct fric_input *input,
                           struct fric_output *output);

/// Resets to the state after set-up: at rest, nothing stored, no pose. The parameters are kept; those of a pending change apply at once, without a
/// blend. It does not allocate, lock or wait.
///
/// # Safety
/// `compensator` is null or a compensator that has not been freed and that nobody else steps or resets now.
enum fric_result fric_reset(struct fric_compensator *compensator);

/// Returns the number of cables of the robot; 0 for a null pointer.
///
/// # Safety
/// `compensator` is null or a compensator that has not been freed.
size_t fric_cable_count(const struct fric_compensator *compensator);

/// Returns the cycle time of the robot, s; 0 for a null pointer.
///
/// # Safety
/// `compensator` is null or a compensator that has not been freed.
double fric_cycle_s(const struct fric_compensator *compensator);

/// Returns the name of the robot in UTF-8; null for a null pointer. The text is valid until fric_free.
///
/// # Safety
/// `compensator` is null or a compensator that has not been freed.
const char *fric_robot_name(const struct fric_compensator *compensator);

/// Returns the name of a cable, counted from 0, in UTF-8; null for a null pointer or a cable that the robot does not have. The text is valid until
/// fric_free.
///
/// # Safety
/// `compensator` is null or a compensator that has not been freed.
const char *fric_cable_name(const struct fric_compensator *compensator,
                            size_t cable);

/// Frees a compensator. Null does nothing. Not for the cycle: it frees memory.
///
/// # Safety
/// `compensator` is null or a compensator that has not been freed; it must not be used afterwards.
void fric_free(struct fric_compensator *compensator);

/// Creates a compensator for the robot of a robot file (TOML, `format = "fric-robot/1"`).
///
/// `path` is UTF-8. On FRIC_RESULT_OK `*compensator` is the new compensator, else null. `error` receives one sentence that says what is wrong, where
/// and what is allowed, cut to `error_size` bytes including the final zero, and is empty without an error; it may be null with size 0. Not for the
/// cycle: it reads a file and allocates. The optimised library uses at most 1024 KiB of stack, 256 KiB for a robot of 16 cables or fewer; so do
/// fric_load_text, fric_change_file and fric_change_text.
///
/// # Safety
/// `path` is null or a zero-terminated string; `compensator` is null or writable; `error` is null or points to `error_size` writable bytes.
enum fric_result fric_load_file(const char *path,
                                struct fric_compensator **compensator,
                                char *error,
                                size_t error_size);

/// Does the same as fric_load_file with the text of a robot file, which has no path: errors name line and key.
///
/// # Safety
/// `toml` is null or a zero-terminated string; the rest as for fric_load_file.
enum fric_result fric_load_text(const char *toml,
                                struct fric_compensator **compensator,
                                char *error,
                                size_t error_size);

/// Returns the version of this library's interface, FRIC_ABI_VERSION of the matching header.
uint32_t fric_abi_version(void);

/// Returns the version of the library, "0.1.0"; the text is always valid.
const char *fric_version(void);

/// Sets the limits of the drives at the base. After set-up the first tendon is pulled from 0 N up to its capacity, and every goal is followed.
///
/// FRIC_RESULT_BAD_VALUE, with the drive unchanged, if a number is NaN or out of its range; `error` then names the number, its value and what is
/// allowed, and is otherwise as in fric_load_file. Only that text allocates.
///
/// # Safety
/// `model` is null or a model that has not been freed and that nobody else uses now. `drive` is null or a structure whose `struct_size` is readable;
/// if that is right, the rest is readable too. `error` is null or points to `error_size` writable bytes.
enum fric_result fric_static_model_set_drive(struct fric_static_model *model,
                                             const struct fric_drive *drive,
                                             char *error,
                                             size_t error_size);

/// Computes the tensions at the base that bring the manipulator to a goal, from the end of the last step of the history. It may run inside the
/// control loop: it does not allocate, lock or wait, accepts any numbers, including NaN, and its iterations are bounded.
///
/// The shape and the memory of the holes are unchanged: fric_static_model_solve, with the tensions that were then set or measured, advances them.
/// FRIC_RESULT_BAD_VALUE for a `kind` or `friction` that is none of the header's. On anything but FRIC_RESULT_OK nothing has happened and the command
/// is unchanged. Goal and command must not share memory.
///
/// # Safety
/// `model` is null or a model that has not been freed and that nobody else uses now. `goal` and `command` are null or structures whose `struct_size`
/// is readable; if that is right, the rest of the goal is readable too, and the rest of the command is writable.
enum fric_result fric_static_model_tension_for(struct fric_static_model *model,
                                               const struct fric_goal *goal,
                                               struct fric_command *command);

/// Creates a static model of the manipulator of a manipulator file (TOML, `format = "fric-continuum/1"`): straight, without tension, with relaxed
/// holes.
///
/// `path` is UTF-8. On FRIC_RESULT_OK `*model` is the new model, else null. `error` is as in fric_load_file. Not for the loop: it reads a file and
/// allocates. The optimised library uses at most 256 KiB of stack, as all functions of a static model do.
///
/// # Safety
/// `path` is null or a zero-terminated string; `model` is null or writable; `error` is null or points to `error_size` writable bytes.
enum fric_result fric_static_model_load_file(const char *path,
                                             struct fric_static_model **model,
                                             char *error,
                                             size_t error_size);

/// Does the same as fric_static_model_load_file with the text of a manipulator file, which has no path: errors name line and key.
///
/// # Safety
/// `toml` is null or a zero-terminated string; the rest as for fric_static_model_load_file.
enum fric_result fric_static_model_load_text(const char *toml,
                                             struct fric_static_model **model,
                                             char *error,
                                             size_t error_size);

/// Returns the manipulator's number of disks without the base plate, which is also the number of segments and of a tendon's holes; 0 for a null
/// pointer.
///
/// # Safety
/// `model` is null or a model that has not been freed.
size_t fric_static_model_disk_count(const struct fric_static_model *model);

/// Returns the name of the manipulator in UTF-8; null for a null pointer. The text is valid until fric_static_model_free.
///
/// # Safety
/// `model` is null or a model that has not been freed.
const char *fric_static_model_name(const struct fric_static_model *model);

/// Resets to the state after set-up: straight, without tension, with relaxed holes. The drive is kept. It does not allocate, lock or wait.
///
/// # Safety
/// `model` is null or a model that has not been freed and that nobody else uses now.
enum fric_result fric_static_model_reset(struct fric_static_model *model);

/// Copies the state of another model of the same manipulator: its shape and the memory of its holes. The drive is kept. With it, a second model can
/// store a state to return to, or look ahead while the first one stays. It does not allocate, lock or wait.
///
/// FRIC_RESULT_WRONG_SIZE, with nothing changed, if the other manipulator has another number of disks.
///
/// # Safety
/// `model` and `from` are each null or a model that has not been freed and that nobody else uses now; they may be the same.
enum fric_result fric_static_model_copy_state(struct fric_static_model *model,
                                              const struct fric_static_model *from);

/// Frees a model. Null does nothing. Not for the loop: it frees memory.
///
/// # Safety
/// `model` is null or a model that has not been freed; it must not be used afterwards.
void fric_static_model_free(struct fric_static_model *model);

/// Computes the shape for tensions at the base. It may run inside the control loop: it does not allocate, lock or wait, accepts any numbers,
/// including NaN, and its iterations are bounded.
///
/// With FRIC_FRICTION_HISTORY this is one step of the run, which begins with the relaxed tendon: call it in every cycle. The other friction models
/// may be solved in between and leave the memory of the holes unchanged. FRIC_RESULT_BAD_VALUE for a `friction` that is none of FRIC_FRICTION_…. On
/// anything but FRIC_RESULT_OK nothing has happened and the output is unchanged. Input and output must not share memory.
///
/// # Safety
/// `model` is null or a model that has not been freed and that nobody else uses now. `input` and `output` are null or structures whose `struct_size`
/// is readable; if that is right, the rest is readable too; `measured` is null or, with FRIC_FRICTION_MEASURED, `measured_count` elements, `disks` is
/// null or `disk_count` writable elements.
enum fric_result fric_static_model_solve(struct fric_static_model *model,
                                         const struct fric_shape_input *input,
                                         struct fric_shape_output *output);

/// Writes the names of the flags in the status of a cable or a wrench, such as "SLACK|SENSOR_JUMP": those of FRIC_STATUS_…, lowest bit first, or "ok"
/// for FRIC_STATUS_OK. Bits that are no flag are left out.
///
/// `text` receives the text, cut to `text_size` bytes including the final zero; FRIC_TEXT_SIZE bytes suffice. It may be null with size 0.
/// Returns the length of the whole text without the final zero, as snprintf does. It may run inside the control loop: it does not allocate, lock or
/// wait.
///
/// # Safety
/// `text` is null or points to `text_size` writable bytes.
size_t fric_status_text(uint32_t status,
                        char *text,
                        size_t text_size);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* FRIC_H */
