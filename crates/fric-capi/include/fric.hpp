/// fric: friction compensation for cable robots, the interface in C++17. Header only, over fric.h.
///
/// Set-up throws fric::Error with a sentence that says what is wrong and where. Nothing in the cycle throws, allocates or
/// locks: `step`, `solve`, `tension_for_…` and `reset` are noexcept and give a code, which only buffers of the wrong size can make
/// other than OK.
/// SI units, in the names. SPDX-License-Identifier: MIT OR Apache-2.0

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

/// Why a compensator or a static model could not be set up.
class Error : public std::runtime_error {
public:
    Error(Result result, const std::string& text) : std::runtime_error(text), result_(result) {}

    /// The code beside the text.
    [[nodiscard]] Result result() const noexcept { return result_; }

private:
    Result result_;
};

namespace detail {

// A string of C++ may hold zeros; for C it would end there, and the rest would be lost without a word.
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

/// Signals of one cycle. Make it at set-up with Compensator::make_input and keep it.
struct Input {
    /// Cables in the robot's order.
    std::vector<CableInput> cables;
    /// Pose of the platform, where it is known.
    std::optional<Pose> pose;
    /// Cycles since the last step, 1 unless some were skipped.
    double elapsed_cycles = 1.0;
};

/// Outcome of one cycle. Make it at set-up with Compensator::make_output and keep it.
struct Output {
    /// Cables in the robot's order.
    std::vector<CableOutput> cables;
    /// What acts on the platform from outside, gravity included, base axes, about the platform origin.
    std::optional<Wrench> outside_wrench;
    /// The same less gravity.
    std::optional<Wrench> applied_wrench;
    /// Every FRIC_STATUS_… flag of any cable that the wrenches are made of.
    std::uint32_t wrench_status = FRIC_STATUS_OK;
};

/// Friction compensation of one robot. It can be moved, not copied. One thread at a time may step or reset it;
/// others may ask and change parameters meanwhile.
class Compensator {
public:
    /// For the robot of a robot file. Throws Error.
    [[nodiscard]] static Compensator from_file(const std::string& path) { return load(::fric_load_file, path); }

    /// For the robot of a robot file's text. Throws Error.
    [[nodiscard]] static Compensator from_text(const std::string& toml) { return load(::fric_load_text, toml); }

    /// One cycle. On anything but FRIC_RESULT_OK nothing has happened and the output is as it was.
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

    /// Back to the state after set-up; the parameters of a change that has been given hold at once.
    Result reset() noexcept { return ::fric_reset(handle_.get()); }

    /// Changes to the parameters of another robot file of the same robot within `blend_s` seconds, from any thread, while
    /// another one steps. Gives false, and changes nothing, until the first step after the blend of the change before.
    /// Throws Error.
    [[nodiscard]] bool change_to_file(const std::string& path, double blend_s) const {
        return change(::fric_change_file, path, blend_s);
    }

    /// The same with the text of a robot file.
    [[nodiscard]] bool change_to_text(const std::string& toml, double blend_s) const {
        return change(::fric_change_text, toml, blend_s);
    }

    /// How many cables the robot has; 0 once moved from.
    [[nodiscard]] std::size_t cable_count() const noexcept { return ::fric_cable_count(handle_.get()); }

    /// Cycle time of the robot, s.
    [[nodiscard]] double cycle_s() const noexcept { return ::fric_cycle_s(handle_.get()); }

    /// Name of the robot.
    [[nodiscard]] std::string robot_name() const { return detail::text(::fric_robot_name(handle_.get())); }

    /// Name of a cable, counted from 0; empty where there is none.
    [[nodiscard]] std::string cable_name(std::size_t cable) const {
        return detail::text(::fric_cable_name(handle_.get(), cable));
    }

    /// Room for the signals of a cycle; allocates.
    [[nodiscard]] Input make_input() const { return Input{std::vector<CableInput>(cable_count()), std::nullopt, 1.0}; }

    /// Room for the outcome of a cycle; allocates.
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

/// How the friction at the holes of a manipulator is found.
enum class Friction : std::uint32_t {
    /// By what each hole remembers of the run of the tensions at the base.
    history = FRIC_FRICTION_HISTORY,
    /// There is none.
    none = FRIC_FRICTION_NONE,
    /// Coulomb's, every hole sliding as pulled.
    pulling = FRIC_FRICTION_PULLING,
    /// Coulomb's, every hole sliding the other way.
    releasing = FRIC_FRICTION_RELEASING,
};

/// A shape of a manipulator. Make it at set-up with StaticModel::make_shape and keep it.
struct Shape {
    /// Disks, the segments that end in them, and the holes these begin with, from the base.
    std::vector<Disk> disks;
    /// Bend of the whole manipulator, rad.
    double bend_rad = 0.0;
    /// FRIC_SHAPE_… flags.
    std::uint32_t status = FRIC_SHAPE_OK;

    /// Whether this is the shape for the tensions given; otherwise it is the last one that was right.
    [[nodiscard]] bool is_new() const noexcept { return (status & FRIC_SHAPE_FAILED) == 0; }
};

/// The tensions to set at the base of a manipulator, and what the model expects of them.
struct Command {
    /// Of the first and the second tendon, N.
    std::array<double, 2> base_tension_n{};
    /// Bend of the whole manipulator then, rad.
    double bend_rad = 0.0;
    /// Centre of the last disk then, base frame, m.
    std::array<double, 2> tip_m{};
    /// FRIC_COMMAND_… flags.
    std::uint32_t status = FRIC_COMMAND_OK;

    /// Whether the goal is reached.
    [[nodiscard]] bool is_reached() const noexcept { return (status & FRIC_COMMAND_MISSED) == 0; }
};

/// What the drives at the base of a manipulator can do.
struct Drive {
    /// Tension that each tendon keeps while the other one is pulled, N.
    std::array<double, 2> least_tension_n{};
    /// Greatest tension of each tendon, N; one for which it is the least is not pulled.
    std::array<double, 2> greatest_tension_n{};
    /// A goal nearer than this, rad (for the tip: this share of the arm's length), leaves the tensions as they are.
    double hold_rad = 0.0;
};

/// Static model of one continuum manipulator: shapes for tensions at the base, and tensions for goals. It can be moved, not
/// copied. One thread at a time may use it.
class StaticModel {
public:
    /// Of the manipulator of a manipulator file. Throws Error.
    [[nodiscard]] static StaticModel from_file(const std::string& path) {
        return StaticModel(detail::load<::fric_static_model>(::fric_static_model_load_file, path));
    }

    /// Of the manipulator of a manipulator file's text. Throws Error.
    [[nodiscard]] static StaticModel from_text(const std::string& toml) {
        return StaticModel(detail::load<::fric_static_model>(::fric_static_model_load_text, toml));
    }

    /// States what the drives can do; after set-up the first tendon is pulled from 0 N to its capacity. Throws Error.
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

    /// The shape for the tensions at the base, N. With Friction::history this is one step of the run: call it in every cycle. On
    /// anything but FRIC_RESULT_OK nothing has happened and the shape is as it was.
    [[nodiscard]] Result solve(const std::array<double, 2>& base_tension_n, Shape& shape,
                               Friction friction = Friction::history) noexcept {
        return solve(base_tension_n, nullptr, 0, static_cast<std::uint32_t>(friction), shape);
    }

    /// The same with the friction that the tensions measured in the segments give, one entry per disk.
    [[nodiscard]] Result solve_measured(const std::array<double, 2>& base_tension_n,
                                        const std::vector<DiskTensions>& measured, Shape& shape) noexcept {
        return solve(base_tension_n, measured.data(), measured.size(), FRIC_FRICTION_MEASURED, shape);
    }

    /// The tensions at the base for a bend of the whole manipulator, rad, from where the last step of the history left it. `solve`, with the
    /// tensions that were set or measured then, moves on what the holes remember.
    [[nodiscard]] Result tension_for_bend(double bend_rad, Command& command,
                                          Friction friction = Friction::history) noexcept {
        return tension_for(FRIC_GOAL_BEND, bend_rad, {}, friction, command);
    }

    /// The same for a position of the tip, base frame, m.
    [[nodiscard]] Result tension_for_tip(const std::array<double, 2>& tip_m, Command& command,
                                         Friction friction = Friction::history) noexcept {
        return tension_for(FRIC_GOAL_TIP, 0.0, tip_m, friction, command);
    }

    /// Back to the state after set-up; the drive stays.
    Result reset() noexcept { return ::fric_static_model_reset(handle_.get()); }

    /// Goes on from where another model of the same manipulator is; the drive stays.
    Result copy_state(const StaticModel& from) noexcept {
        return ::fric_static_model_copy_state(handle_.get(), from.handle_.get());
    }

    /// How many disks the manipulator has; 0 once moved from.
    [[nodiscard]] std::size_t disk_count() const noexcept { return ::fric_static_model_disk_count(handle_.get()); }

    /// Name of the manipulator.
    [[nodiscard]] std::string name() const { return detail::text(::fric_static_model_name(handle_.get())); }

    /// Room for a shape; allocates.
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
