/// fric: friction compensation for cable robots, the interface in C++17. Header only, over fric.h.
///
/// Set-up throws fric::Error with a sentence that says what is wrong and where. Nothing in the cycle throws, allocates or
/// locks: `step` and `reset` are noexcept and give a code, which only buffers of the wrong size can make other than OK.
/// SI units, in the names. SPDX-License-Identifier: MIT OR Apache-2.0

#ifndef FRIC_HPP
#define FRIC_HPP

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

/// Why a compensator could not be set up.
class Error : public std::runtime_error {
public:
    Error(Result result, const std::string& text) : std::runtime_error(text), result_(result) {}

    /// The code beside the text.
    [[nodiscard]] Result result() const noexcept { return result_; }

private:
    Result result_;
};

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
    [[nodiscard]] std::string robot_name() const { return text(::fric_robot_name(handle_.get())); }

    /// Name of a cable, counted from 0; empty where there is none.
    [[nodiscard]] std::string cable_name(std::size_t cable) const {
        return text(::fric_cable_name(handle_.get(), cable));
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

    // A string of C++ may hold zeros; for C it would end there, and the rest would be lost without a word.
    static const char* c_text(const std::string& source) {
        if (source.find('\0') != std::string::npos) {
            throw Error(FRIC_RESULT_ROBOT_FILE, "the text or path has a zero byte in it");
        }
        return source.c_str();
    }

    template <typename Load>
    static Compensator load(Load c_load, const std::string& source) {
        if (::fric_abi_version() != FRIC_ABI_VERSION) {
            throw Error(FRIC_RESULT_WRONG_SIZE, "libfric has ABI version " + std::to_string(::fric_abi_version()) +
                                                    ", this program was built for " + std::to_string(FRIC_ABI_VERSION));
        }
        ::fric_compensator* handle = nullptr;
        char error[1024] = "";
        const Result result = c_load(c_text(source), &handle, error, sizeof error);
        if (result != FRIC_RESULT_OK) {
            throw Error(result, error);
        }
        return Compensator(handle);
    }

    template <typename Change>
    bool change(Change c_change, const std::string& source, double blend_s) const {
        char error[1024] = "";
        const Result result = c_change(handle_.get(), c_text(source), blend_s, error, sizeof error);
        if (result != FRIC_RESULT_OK && result != FRIC_RESULT_BUSY) {
            throw Error(result, error);
        }
        return result == FRIC_RESULT_OK;
    }

    static std::string text(const char* c_string) {
        return c_string == nullptr ? std::string() : std::string(c_string);
    }

    std::unique_ptr<::fric_compensator, Free> handle_;
};

}  // namespace fric

#endif  // FRIC_HPP
