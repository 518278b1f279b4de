/// The rows of a log as CSV, as Python writes them: `fric.read_log("run.mcap").to_pandas().to_csv("run.csv", index=False)`.
/// Cable names with a comma or a quote in them are not for this reader.

#pragma once

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fric.hpp>
#include <fstream>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

/// One cycle's signals with their time.
struct Row {
    std::int64_t stamp_nanos;
    fric::Input input;
};

namespace rows_detail {

inline std::vector<std::string> split(const std::string& line) {
    std::vector<std::string> fields(1);
    for (char letter : line) {
        if (letter == ',') {
            fields.emplace_back();
        } else if (letter != '\r') {
            fields.back() += letter;
        }
    }
    return fields;
}

/// An empty field is a number that is not known.
inline double number(const std::string& field) {
    if (field.empty()) {
        return std::numeric_limits<double>::quiet_NaN();
    }
    char* end = nullptr;
    const double value = std::strtod(field.c_str(), &end);
    if (end != field.c_str() + field.size()) {
        throw std::runtime_error("'" + field + "' is not a number");
    }
    return value;
}

/// Cycles between two stamps: the nearest whole number, for stamps jitter and cycles do not.
inline double elapsed_cycles(std::int64_t last, std::int64_t now, double cycle_s) {
    return std::round(static_cast<double>(now - last) * 1e-9 / cycle_s);
}

}  // namespace rows_detail

/// Reads all rows for the robot of a compensator; throws std::runtime_error with file and line.
inline std::vector<Row> read_rows(const std::string& path, const fric::Compensator& compensator) {
    std::ifstream file(path);
    std::string line;
    if (!std::getline(file, line)) {
        throw std::runtime_error(path + ": cannot be read, or is empty");
    }
    const std::vector<std::string> header = rows_detail::split(line);
    const auto find = [&](const std::string& name) {
        for (std::size_t place = 0; place < header.size(); ++place) {
            if (header[place] == name) {
                return place;
            }
        }
        throw std::runtime_error(path + ": has no column '" + name + "'");
    };
    const std::size_t stamp = find("stamp_nanos");
    std::vector<std::size_t> forces, lengths, speeds, positions, orientations;
    for (std::size_t cable = 0; cable < compensator.cable_count(); ++cable) {
        const std::string name = compensator.cable_name(cable);
        forces.push_back(find("sensor_force_n." + name));
        lengths.push_back(find("length_m." + name));
        speeds.push_back(find("speed_m_per_s." + name));
    }
    for (const char* axis : {"x", "y", "z"}) {
        positions.push_back(find(std::string("position_m.") + axis));
    }
    for (const char* axis : {"x", "y", "z", "w"}) {
        orientations.push_back(find(std::string("orientation_xyzw.") + axis));
    }

    std::vector<Row> rows;
    std::size_t line_number = 1;
    while (std::getline(file, line)) {
        ++line_number;
        try {
            const std::vector<std::string> fields = rows_detail::split(line);
            if (fields.size() != header.size()) {
                throw std::runtime_error("has " + std::to_string(fields.size()) + " fields, the header " +
                                         std::to_string(header.size()));
            }
            Row row{std::strtoll(fields[stamp].c_str(), nullptr, 10), compensator.make_input()};
            for (std::size_t cable = 0; cable < forces.size(); ++cable) {
                row.input.cables[cable] = {rows_detail::number(fields[forces[cable]]),
                                           rows_detail::number(fields[lengths[cable]]),
                                           rows_detail::number(fields[speeds[cable]])};
            }
            fric::Pose pose;
            bool known = true;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                pose.position_m[axis] = rows_detail::number(fields[positions[axis]]);
                known = known && std::isfinite(pose.position_m[axis]);
            }
            for (std::size_t axis = 0; axis < 4; ++axis) {
                pose.orientation_xyzw[axis] = rows_detail::number(fields[orientations[axis]]);
                known = known && std::isfinite(pose.orientation_xyzw[axis]);
            }
            if (known) {
                row.input.pose = pose;
            }
            if (!rows.empty()) {
                row.input.elapsed_cycles =
                    rows_detail::elapsed_cycles(rows.back().stamp_nanos, row.stamp_nanos, compensator.cycle_s());
            }
            rows.push_back(std::move(row));
        } catch (const std::runtime_error& error) {
            throw std::runtime_error(path + ", line " + std::to_string(line_number) + ": " + error.what());
        }
    }
    return rows;
}
