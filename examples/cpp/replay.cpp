/// Replays a log through the control loop's cycle: the same bits as `fric-cli replay` gives.
///
/// Usage: replay ROBOT.toml ROWS.csv OUT.csv    ROWS.csv is made as rows.hpp says.

#include <cstdio>
#include <exception>
#include <fric.hpp>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "rows.hpp"

/// The control loop: nothing in it allocates or throws. Outcomes go where there is room for them already.
static bool run_cycles(fric::Compensator& compensator, const std::vector<Row>& rows,
                       std::vector<fric::Output>& outputs) noexcept {
    for (std::size_t row = 0; row < rows.size(); ++row) {
        if (compensator.step(rows[row].input, outputs[row]) != FRIC_RESULT_OK) {
            return false;
        }
    }
    return true;
}

/// A column per number, in full precision; wrench columns are empty where there is none.
static void write(const std::string& path, const fric::Compensator& compensator, const std::vector<Row>& rows,
                  const std::vector<fric::Output>& outputs) {
    const auto close = [](std::FILE* file) { std::fclose(file); };
    std::unique_ptr<std::FILE, decltype(close)> file(std::fopen(path.c_str(), "w"), close);
    if (!file) {
        throw std::runtime_error(path + ": cannot be written");
    }
    std::fputs("stamp_nanos", file.get());
    for (const char* column : {"force_at_platform_n", "friction_n", "status"}) {
        for (std::size_t cable = 0; cable < compensator.cable_count(); ++cable) {
            std::fprintf(file.get(), ",%s.%s", column, compensator.cable_name(cable).c_str());
        }
    }
    std::fputs(",wrench_status,force_n.x,force_n.y,force_n.z,torque_nm.x,torque_nm.y,torque_nm.z\n", file.get());
    for (std::size_t row = 0; row < rows.size(); ++row) {
        const fric::Output& output = outputs[row];
        std::fprintf(file.get(), "%lld", static_cast<long long>(rows[row].stamp_nanos));
        for (const fric::CableOutput& cable : output.cables) {
            std::fprintf(file.get(), ",%.17g", cable.force_at_platform_n);
        }
        for (const fric::CableOutput& cable : output.cables) {
            std::fprintf(file.get(), ",%.17g", cable.friction_n);
        }
        for (const fric::CableOutput& cable : output.cables) {
            std::fprintf(file.get(), ",%u", static_cast<unsigned>(cable.status));
        }
        std::fprintf(file.get(), ",%u", static_cast<unsigned>(output.wrench_status));
        if (output.outside_wrench) {
            const fric::Wrench& wrench = *output.outside_wrench;
            std::fprintf(file.get(), ",%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n", wrench.force_n[0], wrench.force_n[1],
                         wrench.force_n[2], wrench.torque_nm[0], wrench.torque_nm[1], wrench.torque_nm[2]);
        } else {
            std::fputs(",,,,,,\n", file.get());
        }
    }
    // Closing writes what is left: a full disk may show no sooner.
    const bool is_written = std::ferror(file.get()) == 0;
    if (std::fclose(file.release()) != 0 || !is_written) {
        throw std::runtime_error(path + ": cannot be written");
    }
}

int main(int argc, char** argv) {
    if (argc != 4) {
        std::fprintf(stderr, "usage: %s ROBOT.toml ROWS.csv OUT.csv\n", argv[0]);
        return 2;
    }
    try {
        fric::Compensator compensator = fric::Compensator::from_file(argv[1]);
        const std::vector<Row> rows = read_rows(argv[2], compensator);
        std::vector<fric::Output> outputs(rows.size(), compensator.make_output());
        if (!run_cycles(compensator, rows, outputs)) {
            std::fprintf(stderr, "error: a buffer has the wrong size\n");
            return 1;
        }
        write(argv[3], compensator, rows, outputs);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "error: %s\n", error.what());
        return 1;
    }
    return 0;
}
