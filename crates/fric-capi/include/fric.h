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

/// The goal is a bend of the whole manipulator.
#define FRIC_GOAL_BEND 0

/// The goal is a position of the tip, the centre of the last disk.
#define FRIC_GOAL_TIP 1

/// Friction by what each hole remembers of the run of the tensions at the base.
#define FRIC_FRICTION_HISTORY 0

/// No friction.
#define FRIC_FRICTION_NONE 1

/// Coulomb friction with every hole sliding as pulled: the first tendon is pulled, the second pays out.
#define FRIC_FRICTION_PULLING 2

/// Coulomb friction with every hole sliding the other way.
#define FRIC_FRICTION_RELEASING 3

/// Friction as the tensions measured in the segments give it.
#define FRIC_FRICTION_MEASURED 4

/// Nothing is the matter with the shape.
#define FRIC_SHAPE_OK 0

/// A tension is negative, NaN, infinite or beyond 1e9 N: the shape and what the holes remember stay as they were.
#define FRIC_SHAPE_NOT_FINITE 1

/// No equilibrium was found: the shape and what the holes remember stay as they were.
#define FRIC_SHAPE_NOT_CONVERGED 2

/// The equilibrium is not stable, the arm would leave it: the shape and what the holes remember stay as they were.
#define FRIC_SHAPE_UNSTABLE 4

/// A tension is above what the tendon can bear; computed as usual.
#define FRIC_SHAPE_OVER_CAPACITY 8

/// Disks would touch, the bend is beyond the model; computed as usual.
#define FRIC_SHAPE_DISKS_TOUCH 16

/// The flags with which there is no new shape.
#define FRIC_SHAPE_FAILED 7

/// The command reaches the goal, and the arm moves on in the direction in which it moved before.
#define FRIC_COMMAND_OK 0

/// The goal is not finite, or the friction is FRIC_FRICTION_MEASURED: the tensions as they were.
#define FRIC_COMMAND_NOT_USABLE 1

/// No tension was found: the tensions as they were.
#define FRIC_COMMAND_NOT_CONVERGED 2

/// The tensions of the drive end before the goal, disks would touch, there is no stable shape, or the tip passes the goal by more than 1 %
/// of the arm's length: the tensions that come nearest.
#define FRIC_COMMAND_OUT_OF_REACH 4

/// The goal is nearer than `hold_rad` of the drive: the tensions as they were.
#define FRIC_COMMAND_HELD 8

/// The tendon turns round: friction at the base plate was against this motion before. The goal is reached.
#define FRIC_COMMAND_REVERSAL 16

/// Some hole still has the friction of the motion before, so that much tension moves little. The goal is reached.
#define FRIC_COMMAND_DEAD_BAND 32

/// The flags with which the command does not reach the goal.
#define FRIC_COMMAND_MISSED 7

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

/// Outcome of a call. Anything but FRIC_RESULT_OK has left the compensator or static model, and the output of a step, as they were.
typedef enum fric_result {
  /// Done.
  FRIC_RESULT_OK = 0,
  /// A pointer is null, or not aligned for what it points to.
  FRIC_RESULT_BAD_POINTER = 1,
  /// `struct_size` is not that of this ABI version, `cable_count` not the robot's, or a number of disks not the manipulator's.
  FRIC_RESULT_WRONG_SIZE = 2,
  /// The robot or manipulator file cannot be read, or something in it is wrong; the error text says what, where and what is allowed.
  FRIC_RESULT_ROBOT_FILE = 3,
  /// The change of parameters given before is not over; try again some steps later.
  FRIC_RESULT_BUSY = 4,
  /// A mistake inside of the library, caught; please report it.
  FRIC_RESULT_INTERNAL = 5,
  /// A number that chooses is none of the header's, or one that limits is out of its range.
  FRIC_RESULT_BAD_VALUE = 6,
} fric_result;

/// Friction compensation of one robot: made by fric_load_file or fric_load_text, given back by fric_free.
///
/// One thread at a time may step or reset it. Others may ask for names and numbers and change parameters meanwhile. Several
/// compensators are independent of each other.
typedef struct fric_compensator fric_compensator;

/// Static model of one continuum manipulator: made by fric_static_model_load_file or fric_static_model_load_text, given back by
/// fric_static_model_free.
///
/// Tensions are those of the tendons at the base plate, and positions stand in the base frame. The tables `[base_sensor]` and `[markers]` of
/// the manipulator file are not applied: what such a sensor shows becomes a tension by (shown − offset_n)/gain. One thread at a time may
/// use a model. Others may ask for its name and its number of disks meanwhile. Several models are independent of each other.
typedef struct fric_static_model fric_static_model;

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

/// What the drives at the base can do.
typedef struct fric_drive {
  /// sizeof(fric_drive).
  size_t struct_size;
  /// Tension that each tendon keeps while the other one is pulled, N, at least 0.
  double least_tension_n[2];
  /// Greatest tension of each tendon, N, from the least up to the tendon's capacity. A tendon for which it is the least is not pulled.
  double greatest_tension_n[2];
  /// A goal nearer than this, rad (for the tip: this share of the arm's length), leaves the tensions as they are, so that noise on the goal does not
  /// send them to and fro across the friction of all holes. 0…1.
  double hold_rad;
} fric_drive;

/// What is wanted of the manipulator.
typedef struct fric_goal {
  /// sizeof(fric_goal).
  size_t struct_size;
  /// With FRIC_GOAL_BEND the bend of the whole manipulator, rad, positive towards the first tendon.
  double bend_rad;
  /// With FRIC_GOAL_TIP the centre of the last disk, base frame, m. One tension moves the tip on a curve; the command brings it as near as that curve
  /// comes.
  double tip_m[2];
  /// FRIC_GOAL_BEND or FRIC_GOAL_TIP.
  uint32_t kind;
  /// FRIC_FRICTION_…, but not FRIC_FRICTION_MEASURED, which knows nothing of other tensions. That of a zeroed structure is FRIC_FRICTION_HISTORY.
  uint32_t friction;
} fric_goal;

/// The tensions to set at the base, and what the model expects of them. Set `struct_size`; the call sets the rest. All numbers are
/// finite, whatever went in.
typedef struct fric_command {
  /// sizeof(fric_command).
  size_t struct_size;
  /// Tension at the base of the first and the second tendon, N.
  double base_tension_n[2];
  /// Bend of the whole manipulator then, rad.
  double bend_rad;
  /// Centre of the last disk then, base frame, m.
  double tip_m[2];
  /// FRIC_COMMAND_… flags, FRIC_COMMAND_OK if there is nothing to say.
  uint32_t status;
} fric_command;

/// Tensions measured in the segment that ends in a disk.
typedef struct fric_disk_input {
  /// Of the first and the second tendon, N; 0 in a slack one.
  double tension_n[2];
} fric_disk_input;

/// Tensions of which a shape is wanted.
typedef struct fric_shape_input {
  /// sizeof(fric_shape_input).
  size_t struct_size;
  /// Tension at the base of the first and the second tendon, N; 0 is a slack tendon.
  double base_tension_n[2];
  /// With FRIC_FRICTION_MEASURED the tensions in the segments from the base, else not looked at.
  const struct fric_disk_input *measured;
  /// How many of these; the manipulator's fric_static_model_disk_count. Not looked at without them.
  size_t measured_count;
  /// FRIC_FRICTION_…; that of a zeroed structure is FRIC_FRICTION_HISTORY.
  uint32_t friction;
} fric_shape_input;

/// A disk, the segment that ends in it, and the hole with which that segment begins.
typedef struct fric_disk_output {
  /// Centre of the disk, base frame: x along the straight manipulator, y to the side of the first tendon, m.
  double position_m[2];
  /// Bend of the segment, rad; positive towards the first tendon.
  double bend_rad;
  /// Tension in the segment of the first and the second tendon, N.
  double tension_n[2];
  /// Friction of each tendon at the hole, N; positive where the base side is tighter.
  double friction_n[2];
  /// Greatest friction of each tendon at the hole, N.
  double bound_n[2];
} fric_disk_output;

/// A shape. Set `struct_size`, `disks` and `disk_count`; the solution sets the rest. All numbers are finite, whatever went in.
typedef struct fric_shape_output {
  /// sizeof(fric_shape_output).
  size_t struct_size;
  /// Where disks, segments and holes go, from the base.
  struct fric_disk_output *disks;
  /// How many; the manipulator's, fric_static_model_disk_count.
  size_t disk_count;
  /// Bend of the whole manipulator, the direction of the last disk, rad.
  double bend_rad;
  /// FRIC_SHAPE_… flags, FRIC_SHAPE_OK if nothing is the matter. With one of FRIC_SHAPE_FAILED the shape is the last one that was right,
  /// straight before the first.
  uint32_t status;
} fric_shape_output;

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

/// States what the drives at the base can do; after set-up the first tendon is pulled from 0 N up to its capacity, and every goal is followed.
///
/// FRIC_RESULT_BAD_VALUE, and the drive stays as it was, where a number is NaN or out of its range; `error` then names the number, its value and what
/// is allowed, and is otherwise as in fric_load_file. Only that text allocates.
///
/// # Safety
/// `model` is null or a model that has not been given back and that nobody else uses now. `drive` is null or a structure whose
/// `struct_size` can be read; if that is right, the rest can be too. `error` is null or `error_size` bytes may be written to there.
enum fric_result fric_static_model_set_drive(struct fric_static_model *model,
                                             const struct fric_drive *drive,
                                             char *error,
                                             size_t error_size);

/// The tensions at the base that bring the manipulator to a goal, from where the last step of the history left it: for the inside of the control
/// loop. It does not allocate, lock or wait, takes any numbers, NaN included, and its iterations are bounded.
///
/// The shape and what the holes remember stay as they are: fric_static_model_solve, with the tensions that were set or measured then, moves them
/// on. FRIC_RESULT_BAD_VALUE for a `kind` or `friction` that is none of the header's. On anything but FRIC_RESULT_OK nothing has
/// happened and the command is as it was. Goal and command may share no memory.
///
/// # Safety
/// `model` is null or a model that has not been given back and that nobody else uses now. `goal` and `command` are null or structures whose
/// `struct_size` can be read; if that is right, the rest of the goal can be too, and the rest of the command can be written to.
enum fric_result fric_static_model_tension_for(struct fric_static_model *model,
                                               const struct fric_goal *goal,
                                               struct fric_command *command);

/// Makes a static model of the manipulator of a manipulator file (TOML, `format = "fric-continuum/1"`): straight, without tension, with
/// relaxed holes.
///
/// `path` is UTF-8. On FRIC_RESULT_OK `*model` is the new model, else null. `error` is as in fric_load_file. Not for the loop: it reads a file
/// and allocates. The optimised library takes at most 256 KiB of stack, as all functions of a static model do.
///
/// # Safety
/// `path` is null or a string that ends with zero; `model` is null or may be written to; `error` is null or `error_size` bytes
/// may be written to there.
enum fric_result fric_static_model_load_file(const char *path,
                                             struct fric_static_model **model,
                                             char *error,
                                             size_t error_size);

/// The same for the text of a manipulator file, which has no place of its own: errors name line and key.
///
/// # Safety
/// `toml` is null or a string that ends with zero; the rest as for fric_static_model_load_file.
enum fric_result fric_static_model_load_text(const char *toml,
                                             struct fric_static_model **model,
                                             char *error,
                                             size_t error_size);

/// How many disks the manipulator has beyond the base plate, as many segments, and holes of a tendon; 0 for a null pointer.
///
/// # Safety
/// `model` is null or a model that has not been given back.
size_t fric_static_model_disk_count(const struct fric_static_model *model);

/// Name of the manipulator in UTF-8; null for a null pointer. The text lives until fric_static_model_free.
///
/// # Safety
/// `model` is null or a model that has not been given back.
const char *fric_static_model_name(const struct fric_static_model *model);

/// Back to the state after set-up: straight, without tension, with relaxed holes. The drive stays. It does not allocate, lock or wait.
///
/// # Safety
/// `model` is null or a model that has not been given back and that nobody else uses now.
enum fric_result fric_static_model_reset(struct fric_static_model *model);

/// Brings a model into the state of another one of the same manipulator: its shape and what its holes remember. The drive stays. So a second model
/// keeps a state to come back to, or looks ahead while the first one stays. It does not allocate, lock or wait.
///
/// FRIC_RESULT_WRONG_SIZE, and nothing is changed, where the other manipulator has another number of disks.
///
/// # Safety
/// `model` and `from` are each null or a model that has not been given back and that nobody else uses now; they may be the same.
enum fric_result fric_static_model_copy_state(struct fric_static_model *model,
                                              const struct fric_static_model *from);

/// Gives a model back. Null does nothing. Not for the loop: it frees memory.
///
/// # Safety
/// `model` is null or a model that has not been given back; it is not used afterwards.
void fric_static_model_free(struct fric_static_model *model);

/// The shape for tensions at the base: for the inside of the control loop. It does not allocate, lock or wait, takes any numbers, NaN
/// included, and its iterations are bounded.
///
/// With FRIC_FRICTION_HISTORY this is one step of the run, which begins with the relaxed tendon: call it in every cycle. The other ways of friction
/// may be solved in between and leave what the holes remember as it is. FRIC_RESULT_BAD_VALUE for a `friction` that is none of FRIC_FRICTION_….
/// On anything but FRIC_RESULT_OK nothing has happened and the output is as it was. Input and output may share no memory.
///
/// # Safety
/// `model` is null or a model that has not been given back and that nobody else uses now. `input` and `output` are null or structures
/// whose `struct_size` can be read; if that is right, the rest can be too; `measured` is null or, with FRIC_FRICTION_MEASURED, as many as
/// `measured_count` says, `disks` null or as many as `disk_count` says and writable.
enum fric_result fric_static_model_solve(struct fric_static_model *model,
                                         const struct fric_shape_input *input,
                                         struct fric_shape_output *output);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* FRIC_H */
