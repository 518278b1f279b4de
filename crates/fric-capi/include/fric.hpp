/// fric: friction compensation for cable robots, the interface in C++17. Header only, over fric.h.
///
/// Set-up throws fric::Error with a sentence that states the problem and its place. Nothing in the cycle throws, allocates, or
/// locks: `step`, `solve`, `tension_for_…`, and `reset` are noexcept and return a code. The code differs from OK only if a
/// buffer has the wrong size (FRIC_RESULT_WRONG_SIZE, or FRIC_RESULT_BAD_POINTER if it is empty) or the object has been moved from
/// (FRIC_RESULT_BAD_POINTER).
/// All quantities are in SI units, which the names state. SPDX-License-Identifier: MIT OR Apache-2.0

#ifndef FRIC_HPP
#define FRIC_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "fric.h"

namespace fric {

using CableInput = ::fric_cable_input;
using CableOutput = ::fric_cable_output;
using Pose = ::fric_pose;
using Wrench = ::fric_wrench;
using Result = ::fric_result;

/// Error of the set-up of a compensator or a static model.
class Error : public std::runtime_error {
public:
    Error(Result result, const std::string& text) : std::runtime_error(text), result_(result) {}

    /// Code of the error, in addition to the text.
    [[nodiscard]] Result result() const noexcept { return result_; }

private:
    Result result_;
};

namespace detail {

// A C++ string may contain zero bytes. In C the string would end there, and the rest would be lost silently.
inline const char* c_text(const std::string& source) {
    if (source.find('\0') != std::string::npos) {
        throw Error(FRIC_RESULT_ROBOT_FILE, "the text or path has a zero byte in it");
    }
    return source.c_str();
}

inline std::string text(const char* c_string) { return c_string == nullptr ? std::string() : std::string(c_string); }

template <typename Handle, typename Load>
Handle* load(Load c_load, const std::string& source) {
    if (::fric_abi_version() != FRIC_ABI_VERSION) {
        throw Error(FRIC_RESULT_WRONG_SIZE, "libfric has ABI version " + std::to_string(::fric_abi_version()) +
                                                ", this program was built for " + std::to_string(FRIC_ABI_VERSION));
    }
    Handle* handle = nullptr;
    char error[1024] = "";
    const Result result = c_load(c_text(source), &handle, error, sizeof error);
    if (result != FRIC_RESULT_OK) {
        throw Error(result, error);
    }
    return handle;
}

}  // namespace detail

/// Signals of one cycle. Create it at set-up with Compensator::make_input and reuse it.
struct Input {
    /// Signals of the cables, in the order of the robot.
    std::vector<CableInput> cables;
    /// Pose of the platform, if known.
    std::optional<Pose> pose;
    /// Number of cycles since the last step: 1 unless cycles were skipped. Range as in fric_input: 1 to 1e6.
    double elapsed_cycles = 1.0;
};

/// Output of one cycle. Create it at set-up with Compensator::make_output and reuse it.
struct Output {
    /// Outputs of the cables, in the order of the robot.
    std::vector<CableOutput> cables;
    /// External wrench on the platform including gravity, in base axes, about the platform origin.
    std::optional<Wrench> outside_wrench;
    /// External wrench without gravity.
    std::optional<Wrench> applied_wrench;
    /// All FRIC_STATUS_… flags of the cables from which the wrenches are computed.
    std::uint32_t wrench_status = FRIC_STATUS_OK;
};

/// Returns the names of the flags in the status of a cable or a wrench, such as "SLACK|SENSOR_JUMP", or "ok" if there is none.
/// Allocates; fric_status_text does not.
[[nodiscard]] inline std::string status_text(std::uint32_t status) {
    char text[FRIC_TEXT_SIZE] = "";
    ::fric_status_text(status, text, sizeof text);
    return text;
}

/// Friction compensation of one robot. It can be moved, not copied. Only one thread at a time may step or reset it;
/// other threads may query it and change parameters meanwhile.
class Compensator {
public:
    /// Creates the compensator of the robot in a robot file. Throws Error.
    [[nodiscard]] static Compensator from_file(const std::string& path) { return load(::fric_load_file, path); }

    /// Creates the compensator of the robot in the text of a robot file. Throws Error.
    [[nodiscard]] static Compensator from_text(const std::string& toml) { return load(::fric_load_text, toml); }

    /// Computes one cycle. If the code is not FRIC_RESULT_OK, nothing has happened and the output is unchanged.
    [[nodiscard]] Result step(const Input& input, Output& output) noexcept {
        ::fric_input c_input{};
        c_input.struct_size = sizeof c_input;
        c_input.cables = input.cables.data();
        c_input.cable_count = input.cables.size();
        c_input.pose = input.pose ? &*input.pose : nullptr;
        c_input.elapsed_cycles = input.elapsed_cycles;
        ::fric_output c_output{};
        c_output.struct_size = sizeof c_output;
        c_output.cables = output.cables.data();
        c_output.cable_count = output.cables.size();
        const Result result = ::fric_step(handle_.get(), &c_input, &c_output);
        if (result == FRIC_RESULT_OK) {
            output.outside_wrench = c_output.has_wrench ? std::optional(c_output.outside_wrench) : std::nullopt;
            output.applied_wrench = c_output.has_wrench ? std::optional(c_output.applied_wrench) : std::nullopt;
            output.wrench_status = c_output.wrench_status;
        }
        return result;
    }

    /// Resets to the state after set-up. The parameters of a requested change apply at once.
    Result reset() noexcept { return ::fric_reset(handle_.get()); }

    /// Changes to the parameters of another robot file of the same robot within `blend_s` seconds. Any thread may call it while
    /// another one steps. Returns false and changes nothing until the first step after the blend of the previous change.
    /// Throws Error.
    [[nodiscard]] bool change_to_file(const std::string& path, double blend_s) const {
        return change(::fric_change_file, path, blend_s);
    }

    /// Changes to the parameters in the text of a robot file, like `change_to_file`. Throws Error.
    [[nodiscard]] bool change_to_text(const std::string& toml, double blend_s) const {
        return change(::fric_change_text, toml, blend_s);
    }

    /// Returns the number of cables of the robot, or 0 after a move.
    [[nodiscard]] std::size_t cable_count() const noexcept { return ::fric_cable_count(handle_.get()); }

    /// Returns the cycle time of the robot in s.
    [[nodiscard]] double cycle_s() const noexcept { return ::fric_cycle_s(handle_.get()); }

    /// Returns the name of the robot.
    [[nodiscard]] std::string robot_name() const { return detail::text(::fric_robot_name(handle_.get())); }

    /// Returns the name of a cable, counted from 0, or an empty string if there is no such cable.
    [[nodiscard]] std::string cable_name(std::size_t cable) const {
        return detail::text(::fric_cable_name(handle_.get(), cable));
    }

    /// Creates the signals of a cycle. Allocates.
    [[nodiscard]] Input make_input() const { return Input{std::vector<CableInput>(cable_count()), std::nullopt, 1.0}; }

    /// Creates the output of a cycle. Allocates.
    [[nodiscard]] Output make_output() const {
        return Output{std::vector<CableOutput>(cable_count()), std::nullopt, std::nullopt, FRIC_STATUS_OK};
    }

private:
    struct Free {
        void operator()(::fric_compensator* handle) const noexcept { ::fric_free(handle); }
    };

    explicit Compensator(::fric_compensator* handle) noexcept : handle_(handle) {}

    template <typename Load>
    static Compensator load(Load c_load, const std::string& source) {
        return Compensator(detail::load<::fric_compensator>(c_load, source));
    }

    template <typename Change>
    bool change(Change c_change, const std::string& source, double blend_s) const {
        char error[1024] = "";
        const Result result = c_change(handle_.get(), detail::c_text(source), blend_s, error, sizeof error);
        if (result != FRIC_RESULT_OK && result != FRIC_RESULT_BUSY) {
            throw Error(result, error);
        }
        return result == FRIC_RESULT_OK;
    }

    std::unique_ptr<::fric_compensator, Free> handle_;
};

using DiskTensions = ::fric_disk_input;
using Disk = ::fric_disk_output;

/// Source of the friction at the holes of a manipulator.
enum class Friction : std::uint32_t {
    /// The friction follows from the state of each hole, which depends on the history of the tensions at the base.
    history = FRIC_FRICTION_HISTORY,
    /// No friction.
    none = FRIC_FRICTION_NONE,
    /// Coulomb friction, with every hole sliding in the direction of the pull.
    pulling = FRIC_FRICTION_PULLING,
    /// Coulomb friction, with every hole sliding against the direction of the pull.
    releasing = FRIC_FRICTION_RELEASING,
};

/// Shape of a manipulator. Create it at set-up with StaticModel::make_shape and reuse it.
struct Shape {
    /// Disks, the segments that end at them, and the holes at which the segments begin, from the base.
    std::vector<Disk> disks;
    /// Bend of the whole manipulator, rad.
    double bend_rad = 0.0;
    /// FRIC_SHAPE_… flags.
    std::uint32_t status = FRIC_SHAPE_OK;

    /// Returns whether this is the shape for the given tensions. Otherwise it is the last valid shape.
    [[nodiscard]] bool is_new() const noexcept { return (status & FRIC_SHAPE_FAILED) == 0; }
};

/// Tensions to set at the base of a manipulator, and the prediction of the model for them.
struct Command {
    /// Tensions of the first and the second tendon, N.
    std::array<double, 2> base_tension_n{};
    /// Predicted bend of the whole manipulator, rad.
    double bend_rad = 0.0;
    /// Predicted centre of the last disk, base frame, m.
    std::array<double, 2> tip_m{};
    /// FRIC_COMMAND_… flags.
    std::uint32_t status = FRIC_COMMAND_OK;

    /// Returns whether the goal is reached.
    [[nodiscard]] bool is_reached() const noexcept { return (status & FRIC_COMMAND_MISSED) == 0; }
};

/// Limits of the drives at the base of a manipulator.
struct Drive {
    /// Tension that each tendon keeps while the other one is pulled, N.
    std::array<double, 2> least_tension_n{};
    /// Greatest tension of each tendon, N. A tendon whose greatest tension equals its least is not pulled.
    std::array<double, 2> greatest_tension_n{};
    /// If a goal is nearer than this, the tensions stay unchanged: rad, or for the tip a fraction of the arm's length.
    double hold_rad = 0.0;
};

/// Static model of one continuum manipulator: shapes for tensions at the base, and tensions for goals. It can be moved, not
/// copied. Only one thread at a time may use it.
class StaticModel {
public:
    /// Creates the model of the manipulator in a manipulator file. Throws Error.
    [[nodiscard]] static StaticModel from_file(const std::string& path) {
        return StaticModel(detail::load<::fric_static_model>(::fric_static_model_load_file, path));
    }

    /// Creates the model of the manipulator in the text of a manipulator file. Throws Error.
    [[nodiscard]] static StaticModel from_text(const std::string& toml) {
        return StaticModel(detail::load<::fric_static_model>(::fric_static_model_load_text, toml));
    }

    /// Sets the limits of the drives. After set-up, the first tendon is pulled from 0 N to its capacity. Throws Error.
    void set_drive(const Drive& drive) {
        ::fric_drive c_drive{};
        c_drive.struct_size = sizeof c_drive;
        for (std::size_t tendon = 0; tendon < 2; ++tendon) {
            c_drive.least_tension_n[tendon] = drive.least_tension_n[tendon];
            c_drive.greatest_tension_n[tendon] = drive.greatest_tension_n[tendon];
        }
        c_drive.hold_rad = drive.hold_rad;
        char error[256] = "";
        const Result result = ::fric_static_model_set_drive(handle_.get(), &c_drive, error, sizeof error);
        if (result != FRIC_RESULT_OK) {
            throw Error(result, error);
        }
    }

    /// Computes the shape for the tensions at the base, N. With Friction::history, each call is one step of the history: call it
    /// in every cycle. If the code is not FRIC_RESULT_OK, nothing has happened and the shape is unchanged.
    [[nodiscard]] Result solve(const std::array<double, 2>& base_tension_n, Shape& shape,
                               Friction friction = Friction::history) noexcept {
        return solve(base_tension_n, nullptr, 0, static_cast<std::uint32_t>(friction), shape);
    }

    /// Computes the shape with the friction that follows from the tensions measured in the segments, one entry per disk.
    [[nodiscard]] Result solve_measured(const std::array<double, 2>& base_tension_n,
                                        const std::vector<DiskTensions>& measured, Shape& shape) noexcept {
        return solve(base_tension_n, measured.data(), measured.size(), FRIC_FRICTION_MEASURED, shape);
    }

    /// Computes the tensions at the base for a bend of the whole manipulator, rad, from the state after the last step of the history.
    /// The state of the holes advances only when `solve` is called with the tensions that were then set or measured.
    [[nodiscard]] Result tension_for_bend(double bend_rad, Command& command,
                                          Friction friction = Friction::history) noexcept {
        return tension_for(FRIC_GOAL_BEND, bend_rad, {}, friction, command);
    }

    /// Computes the tensions at the base for a position of the tip, base frame, m.
    [[nodiscard]] Result tension_for_tip(const std::array<double, 2>& tip_m, Command& command,
                                         Friction friction = Friction::history) noexcept {
        return tension_for(FRIC_GOAL_TIP, 0.0, tip_m, friction, command);
    }

    /// Resets to the state after set-up. The limits of the drives are kept.
    Result reset() noexcept { return ::fric_static_model_reset(handle_.get()); }

    /// Copies the state of another model of the same manipulator. The limits of the drives are kept.
    Result copy_state(const StaticModel& from) noexcept {
        return ::fric_static_model_copy_state(handle_.get(), from.handle_.get());
    }

    /// Returns the number of disks of the manipulator, or 0 after a move.
    [[nodiscard]] std::size_t disk_count() const noexcept { return ::fric_static_model_disk_count(handle_.get()); }

    /// Returns the name of the manipulator.
    [[nodiscard]] std::string name() const { return detail::text(::fric_static_model_name(handle_.get())); }

    /// Creates a shape. Allocates.
    [[nodiscard]] Shape make_shape() const { return Shape{std::vector<Disk>(disk_count()), 0.0, FRIC_SHAPE_OK}; }

private:
    struct Free {
        void operator()(::fric_static_model* handle) const noexcept { ::fric_static_model_free(handle); }
    };

    explicit StaticModel(::fric_static_model* handle) noexcept : handle_(handle) {}

    Result solve(const std::array<double, 2>& base_tension_n, const DiskTensions* measured, std::size_t measured_count,
                 std::uint32_t friction, Shape& shape) noexcept {
        ::fric_shape_input c_input{};
        c_input.struct_size = sizeof c_input;
        c_input.base_tension_n[0] = base_tension_n[0];
        c_input.base_tension_n[1] = base_tension_n[1];
        c_input.measured = measured;
        c_input.measured_count = measured_count;
        c_input.friction = friction;
        ::fric_shape_output c_output{};
        c_output.struct_size = sizeof c_output;
        c_output.disks = shape.disks.data();
        c_output.disk_count = shape.disks.size();
        const Result result = ::fric_static_model_solve(handle_.get(), &c_input, &c_output);
        if (result == FRIC_RESULT_OK) {
            shape.bend_rad = c_output.bend_rad;
            shape.status = c_output.status;
        }
        return result;
    }

    Result tension_for(std::uint32_t kind, double bend_rad, const std::array<double, 2>& tip_m, Friction friction,
                       Command& command) noexcept {
        ::fric_goal c_goal{};
        c_goal.struct_size = sizeof c_goal;
        c_goal.kind = kind;
        c_goal.bend_rad = bend_rad;
        c_goal.tip_m[0] = tip_m[0];
        c_goal.tip_m[1] = tip_m[1];
        c_goal.friction = static_cast<std::uint32_t>(friction);
        ::fric_command c_command{};
        c_command.struct_size = sizeof c_command;
        const Result result = ::fric_static_model_tension_for(handle_.get(), &c_goal, &c_command);
        if (result == FRIC_RESULT_OK) {
            command.base_tension_n = {c_command.base_tension_n[0], c_command.base_tension_n[1]};
            command.bend_rad = c_command.bend_rad;
            command.tip_m = {c_command.tip_m[0], c_command.tip_m[1]};
            command.status = c_command.status;
        }
        return result;
    }

    std::unique_ptr<::fric_static_model, Free> handle_;
};

}  // namespace fric

#endif  // FRIC_HPP
