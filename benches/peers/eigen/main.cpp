// eigen run|time lumped|per_pulley INPUT ROUNDS   |   eigen output lumped|per_pulley INPUT FILE
// INPUT is what `cycle_instructions input FILE` writes; `time` prints nanoseconds per cycle in the best round.

#include "cycle.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <limits>
#include <string>

namespace {

struct Problem {
    std::vector<peer::CableParams> cables;
    std::vector<peer::CycleInput> inputs;
};

Problem read(const char* path) {
    std::ifstream file(path);
    std::size_t cables = 0, cycles = 0;
    file >> cables >> cycles;
    if (!file || cables != 8) {
        std::cerr << path << " is no input for 8 cables\n";
        std::exit(2);
    }
    Problem problem;
    problem.cables.resize(cables);
    problem.inputs.resize(cycles);
    for (auto& cable : problem.cables) {
        file >> cable.mu >> cable.sigma_n_per_m >> cable.viscous_n_s_per_m >> cable.offset_n;
        for (double& part : cable.base_m) file >> part;
        for (double& part : cable.platform_m) file >> part;
    }
    for (auto& input : problem.inputs) {
        for (double& part : input.position_m) file >> part;
        for (double& part : input.orientation.coeffs()) file >> part;
        for (auto& cable : input.cables) file >> cable.sensor_force_n >> cable.length_m >> cable.speed_m_per_s;
    }
    return problem;
}

// The compiler must take the value for used.
template <typename T>
void keep(T& value) {
    asm volatile("" : : "r"(&value) : "memory");
}

template <bool Lumped>
int work(const std::string& command, const Problem& problem, const char* last) {
    peer::Compensator<8, Lumped> compensator(problem.cables, 0.41, {0.01, -0.02, 0.005});
    peer::CycleOutput<8> output;
    if (command == "output") {
        std::FILE* file = std::fopen(last, "w");
        if (file == nullptr) return 2;
        for (const auto& input : problem.inputs) {
            compensator.step(input, output);
            for (double force_n : output.force_at_platform_n) std::fprintf(file, "%.17g ", force_n);
            for (double part : output.outside_wrench) std::fprintf(file, "%.17g ", part);
            std::fputc('\n', file);
        }
        return std::fclose(file);
    }
    const long rounds = std::atol(last);
    double best_ns = std::numeric_limits<double>::infinity();
    for (long round = 0; round < rounds; ++round) {
        const auto start = std::chrono::steady_clock::now();
        for (const auto& input : problem.inputs) {
            compensator.step(input, output);
            keep(output);
        }
        const std::chrono::duration<double, std::nano> elapsed = std::chrono::steady_clock::now() - start;
        best_ns = std::min(best_ns, elapsed.count());
    }
    if (command == "time") std::printf("%g\n", best_ns / static_cast<double>(problem.inputs.size()));
    return 0;
}

}  // namespace

int main(int count, char** arguments) {
    if (count != 5) {
        std::cerr << "see the head of main.cpp for the ways to call this\n";
        return 2;
    }
    const Problem problem = read(arguments[3]);
    const bool lumped = std::string(arguments[2]) == "lumped";
    return lumped ? work<true>(arguments[1], problem, arguments[4]) : work<false>(arguments[1], problem, arguments[4]);
}
