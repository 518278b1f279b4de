/* Steps a robot with floating-point traps on: any invalid operation or division by zero ends the program with a signal.
 *
 * Usage: traps ROBOT.toml
 *
 * Cables run to and fro under a load that varies, go slack, jump, skip cycles and lose their pose: all of it finite. */

#define _GNU_SOURCE
#include <fenv.h>
#include <fric.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

enum { MOST_CABLES = 64, CYCLE_COUNT = 20000 };

int main(int argc, char **argv) {
    fric_compensator *compensator = NULL;
    char error[512];
    if (argc != 2 || fric_load_file(argv[1], &compensator, error, sizeof error) != FRIC_RESULT_OK) {
        fprintf(stderr, "error: %s\n", argc == 2 ? error : "usage: traps ROBOT.toml");
        return 1;
    }
    fric_cable_input signals[MOST_CABLES];
    fric_cable_output results[MOST_CABLES];
    const size_t cable_count = fric_cable_count(compensator);
    const double cycle_s = fric_cycle_s(compensator);
    feclearexcept(FE_ALL_EXCEPT);
    feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW);
    double sum_n = 0.0;
    for (int cycle = 0; cycle < CYCLE_COUNT; ++cycle) {
        const double time_s = cycle_s * cycle;
        for (size_t cable = 0; cable < cable_count; ++cable) {
            const double phase = 0.7 * (double)cable;
            const double omega = 2.0 + 0.1 * (double)cable;
            signals[cable].sensor_force_n = 15.0 + 10.0 * sin(0.9 * time_s + phase) + 1e-3 * (cycle % 10);
            signals[cable].length_m = 1.0 + 0.05 * sin(omega * time_s + phase);
            signals[cable].speed_m_per_s = 0.05 * omega * cos(omega * time_s + phase);
            if (cycle % 4000 > 3900) {
                /* Rests, then pulls nothing, pushes, and shows too much. */
                signals[cable].length_m = 1.0;
                signals[cable].speed_m_per_s = 0.0;
                signals[cable].sensor_force_n = (double[]){0.0, -3.0, 1e6, 1e-300}[cycle % 4];
            }
        }
        const double tilt = 0.05 * sin(1.3 * time_s);
        const fric_pose pose = {.position_m = {0.05 * sin(2.0 * time_s), 0.03 * cos(1.7 * time_s), 0.02},
                                .orientation_xyzw = {tilt, 0.0, 0.0, sqrt(1.0 - tilt * tilt)}};
        const fric_input input = {.struct_size = sizeof input,
                                  .cables = signals,
                                  .cable_count = cable_count,
                                  .pose = cycle % 1000 == 999 ? NULL : &pose,
                                  .elapsed_cycles = cycle % 777 == 776 ? 3.0 : 1.0};
        fric_output output = {.struct_size = sizeof output, .cables = results, .cable_count = cable_count};
        if (fric_step(compensator, &input, &output) != FRIC_RESULT_OK) {
            return 1;
        }
        for (size_t cable = 0; cable < cable_count; ++cable) {
            sum_n += results[cable].force_at_platform_n;
        }
    }
    fedisableexcept(FE_ALL_EXCEPT);
    printf("%.3f\n", sum_n);
    fric_free(compensator);
    return 0;
}
