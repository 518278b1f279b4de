/// A real-time loop around the compensator: 1 kHz, or what the robot file says, on Linux.
///
/// Usage: control_loop ROBOT.toml ROWS.csv [SECONDS]    ROWS.csv is made as rows.hpp says; it stands for the bus, over and over.
///
/// Memory is locked, the thread sleeps until absolute times, and it has real-time priority where the system permits. Whole
/// cycles that it comes too late for (an overrun) are skipped and told by `elapsed_cycles`. At the end: overruns, wake-up latency,
/// duration of a step, page faults and memory taken since the first cycle. Exits 1 if there was a page fault or memory was taken.

#include <malloc.h>
#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <time.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <fric.hpp>
#include <string>
#include <vector>

#include "rows.hpp"

namespace {

constexpr std::int64_t second_nanos = 1'000'000'000;

std::int64_t now_nanos() noexcept {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * second_nanos + now.tv_nsec;
}

void sleep_until(std::int64_t nanos) noexcept {
    const timespec until{static_cast<time_t>(nanos / second_nanos), static_cast<long>(nanos % second_nanos)};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
    }
}

/// Says what the system does not permit, and goes on: the figures at the end tell what that costs.
void become_real_time() {
    if (mlockall(MCL_CURRENT | MCL_FUTURE) != 0) {
        std::printf("memory is not locked: %s\n", std::strerror(errno));
    }
    sched_param priority{};
    priority.sched_priority = 80;
    if (sched_setscheduler(0, SCHED_FIFO, &priority) != 0) {
        std::printf("no real-time priority: %s\n", std::strerror(errno));
    }
}

/// What the kernel and the allocator have counted.
struct Counters {
    long minor_faults, major_faults;
    std::size_t bytes_taken;

    static Counters read() noexcept {
        rusage usage{};
        getrusage(RUSAGE_SELF, &usage);
        const auto memory = mallinfo2();
        return {usage.ru_minflt, usage.ru_majflt, memory.uordblks + memory.hblkhd};
    }
};

/// Durations of as many cycles as there is room for.
struct Durations {
    std::vector<std::int64_t> nanos;

    void show(const char* name) {
        std::sort(nanos.begin(), nanos.end());
        const auto at = [&](double share) {
            return nanos[std::min(nanos.size() - 1, static_cast<std::size_t>(share * static_cast<double>(nanos.size())))];
        };
        std::printf("%-8s %9.3f %9.3f %9.3f %9.3f\n", name, static_cast<double>(at(0.5)) * 1e-3,
                    static_cast<double>(at(0.999)) * 1e-3, static_cast<double>(at(0.99999)) * 1e-3,
                    static_cast<double>(nanos.back()) * 1e-3);
    }
};

struct Loop {
    Durations wake_up, step;
    Counters before{}, after{};
    std::uint64_t flagged = 0, overruns = 0, skipped = 0;
    std::uint32_t flags = FRIC_STATUS_OK;

    /// Nothing in it allocates or throws.
    bool run(fric::Compensator& compensator, std::vector<Row>& rows, fric::Output& output,
             std::int64_t cycle_nanos) noexcept {
        std::int64_t due = now_nanos() + cycle_nanos;
        std::size_t row = 0;
        for (std::size_t cycle = 0; cycle < step.nanos.size(); ++cycle) {
            sleep_until(due);
            const std::int64_t late = now_nanos() - due;
            const std::int64_t missed = late / cycle_nanos;
            // The bus has not waited.
            row = (row + static_cast<std::size_t>(missed)) % rows.size();
            fric::Input& input = rows[row].input;
            input.elapsed_cycles = 1.0 + static_cast<double>(missed);
            const std::int64_t start = now_nanos();
            const fric::Result result = compensator.step(input, output);
            const std::int64_t end = now_nanos();
            if (result != FRIC_RESULT_OK) {
                return false;
            }
            wake_up.nanos[cycle] = late;
            step.nanos[cycle] = end - start;
            overruns += missed > 0;
            skipped += static_cast<std::uint64_t>(missed);
            flagged += output.wrench_status != FRIC_STATUS_OK;
            flags |= output.wrench_status;
            if (cycle == 0) {
                before = Counters::read();
            }
            row = (row + 1) % rows.size();
            due += (1 + missed) * cycle_nanos;
        }
        after = Counters::read();
        return true;
    }
};

}  // namespace

int main(int argc, char** argv) {
    if (argc < 3 || argc > 4) {
        std::fprintf(stderr, "usage: %s ROBOT.toml ROWS.csv [SECONDS]\n", argv[0]);
        return 2;
    }
    try {
        fric::Compensator compensator = fric::Compensator::from_file(argv[1]);
        std::vector<Row> rows = read_rows(argv[2], compensator);
        const double seconds = argc > 3 ? std::atof(argv[3]) : 60.0;
        // Checked before it becomes a whole number: NaN and what does not fit would be undefined.
        const bool in_range = seconds >= compensator.cycle_s() && seconds < 1e6;
        const std::size_t cycle_count = in_range ? static_cast<std::size_t>(seconds / compensator.cycle_s()) : 0;
        if (cycle_count == 0 || rows.empty()) {
            std::fprintf(stderr, "error: there is no cycle to run: give SECONDS and a file with rows\n");
            return 2;
        }
        fric::Output output = compensator.make_output();
        Loop loop;
        loop.wake_up.nanos.assign(cycle_count, 0);
        loop.step.nanos.assign(cycle_count, 0);
        become_real_time();
        if (!loop.run(compensator, rows, output, std::llround(compensator.cycle_s() * 1e9))) {
            std::fprintf(stderr, "error: a buffer has the wrong size\n");
            return 1;
        }
        std::printf("%zu cycles, %llu flagged: %s\n", cycle_count, static_cast<unsigned long long>(loop.flagged),
                    fric::status_text(loop.flags).c_str());
        std::printf("%llu overruns, %llu cycles skipped\n", static_cast<unsigned long long>(loop.overruns),
                    static_cast<unsigned long long>(loop.skipped));
        std::printf("%-8s %9s %9s %9s %9s\n", "us", "p50", "p99.9", "p99.999", "max");
        loop.wake_up.show("wake-up");
        loop.step.show("step");
        const long minor = loop.after.minor_faults - loop.before.minor_faults;
        const long major = loop.after.major_faults - loop.before.major_faults;
        const auto taken = static_cast<long long>(loop.after.bytes_taken - loop.before.bytes_taken);
        std::printf("since the first cycle: %ld minor and %ld major page faults, %lld bytes allocated\n", minor, major, taken);
        return minor == 0 && major == 0 && taken == 0 ? 0 : 1;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "error: %s\n", error.what());
        return 1;
    }
}
