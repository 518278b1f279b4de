/// A loop around the arm of a continuum manipulator: a path of bends goes in, the tension to set at the base comes out, and the measured tension
/// moves on what the holes remember.
///
/// Usage: arm_loop MANIPULATOR.toml PATH.csv OUT.csv    PATH.csv: a header line, then one bend in rad a line.

#include <array>
#include <cstdio>
#include <exception>
#include <fric.hpp>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

/// What one cycle of the loop gives.
struct Cycle {
    fric::Command command;
    fric::Shape shape;
};

/// Stands in for the drive and its sensor: the tension is as it was set, but for the last bits of a converter of 0.1 mN.
static double measured_n(double set_n) noexcept {
    constexpr double step_n = 1e-4;
    return step_n * static_cast<double>(static_cast<long>(set_n / step_n + 0.5));
}

/// The control loop: nothing in it allocates or throws. Outcomes go where there is room for them already.
static bool run_cycles(fric::StaticModel& model, const std::vector<double>& bends_rad,
                       std::vector<Cycle>& cycles) noexcept {
    for (std::size_t place = 0; place < bends_rad.size(); ++place) {
        Cycle& cycle = cycles[place];
        if (model.tension_for_bend(bends_rad[place], cycle.command) != FRIC_RESULT_OK) {
            return false;
        }
        const std::array<double, 2> base_tension_n = {measured_n(cycle.command.base_tension_n[0]), 0.0};
        if (model.solve(base_tension_n, cycle.shape) != FRIC_RESULT_OK) {
            return false;
        }
    }
    return true;
}

static std::vector<double> read_path(const std::string& path) {
    std::ifstream file(path);
    if (!file) {
        throw std::runtime_error(path + ": cannot be read");
    }
    std::vector<double> bends_rad;
    std::string line;
    std::getline(file, line);
    while (std::getline(file, line)) {
        std::size_t end = 0;
        try {
            bends_rad.push_back(std::stod(line, &end));
        } catch (const std::exception&) {
            end = std::string::npos;
        }
        if (end != line.size()) {
            throw std::runtime_error(path + ": '" + line + "' is no number");
        }
    }
    return bends_rad;
}

/// A column per number, in full precision.
static void write(const std::string& path, const std::vector<double>& bends_rad, const std::vector<Cycle>& cycles) {
    std::ofstream file(path);
    const auto number = [&file](double value) {
        char text[32];
        std::snprintf(text, sizeof text, ",%.17g", value);
        file << text;
    };
    file << "wanted_rad,tension_n,bend_rad,tip_x_m,tip_y_m,tip_tension_n,goal_status,shape_status\n";
    for (std::size_t place = 0; place < cycles.size(); ++place) {
        const auto& [command, shape] = cycles[place];
        const fric::Disk& tip = shape.disks.back();
        file << bends_rad[place];
        number(command.base_tension_n[0]);
        for (const double value : {shape.bend_rad, tip.position_m[0], tip.position_m[1], tip.tension_n[0]}) {
            number(value);
        }
        file << ',' << command.status << ',' << shape.status << '\n';
    }
    if (!file.flush()) {
        throw std::runtime_error(path + ": cannot be written");
    }
}

int main(int argc, char** argv) {
    if (argc != 4) {
        std::fprintf(stderr, "usage: %s MANIPULATOR.toml PATH.csv OUT.csv\n", argv[0]);
        return 2;
    }
    try {
        fric::StaticModel model = fric::StaticModel::from_file(argv[1]);
        fric::Drive drive;
        drive.greatest_tension_n = {3.0, 0.0};
        drive.hold_rad = 1e-3;  // noise of the goal below this does not send the tension to and fro
        model.set_drive(drive);
        const std::vector<double> bends_rad = read_path(argv[2]);
        std::vector<Cycle> cycles(bends_rad.size(), Cycle{fric::Command{}, model.make_shape()});
        if (!run_cycles(model, bends_rad, cycles)) {
            throw std::runtime_error("a buffer has the wrong size");
        }
        write(argv[3], bends_rad, cycles);
        std::size_t missed = 0;
        for (const Cycle& cycle : cycles) {
            if (!cycle.command.is_reached()) {
                ++missed;
            }
        }
        std::printf("%s: %zu goals, %zu out of reach\n", model.name().c_str(), cycles.size(), missed);
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "error: %s\n", error.what());
        return 1;
    }
}
