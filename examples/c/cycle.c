/* Friction compensation in C: set-up, some cycles, what comes out.
 *
 * Usage: cycle ROBOT.toml */

#include <fric.h>
#include <stdio.h>
#include <stdlib.h>

enum { MOST_CABLES = 64 };

int main(int argc, char **argv) {
    if (argc != 2) {
        fprintf(stderr, "usage: %s ROBOT.toml\n", argv[0]);
        return 2;
    }
    if (fric_abi_version() != FRIC_ABI_VERSION) {
        fprintf(stderr, "libfric has ABI version %u, this program needs %d\n", fric_abi_version(), FRIC_ABI_VERSION);
        return 1;
    }

    /* Set-up may fail: it says which file, line and key, and what is allowed. */
    fric_compensator *compensator = NULL;
    char error[512];
    if (fric_load_file(argv[1], &compensator, error, sizeof error) != FRIC_RESULT_OK) {
        fprintf(stderr, "error: %s\n", error);
        return 1;
    }

    fric_cable_input signals[MOST_CABLES] = {{0}};
    fric_cable_output results[MOST_CABLES];
    const fric_pose pose = {.position_m = {0.0, 0.0, 0.0}, .orientation_xyzw = {0.0, 0.0, 0.0, 1.0}};
    const size_t cable_count = fric_cable_count(compensator);
    const fric_input input = {
        .struct_size = sizeof input, .cables = signals, .cable_count = cable_count, .pose = &pose, .elapsed_cycles = 1.0};
    fric_output output = {.struct_size = sizeof output, .cables = results, .cable_count = cable_count};

    /* The cycle: 1 s of paying out at 0.05 m/s under 15 N. It does not allocate, lock or fail on any signal. */
    const double cycle_s = fric_cycle_s(compensator);
    const int cycle_count = (int)(1.0 / cycle_s);
    for (int cycle = 0; cycle < cycle_count; ++cycle) {
        for (size_t cable = 0; cable < cable_count; ++cable) {
            signals[cable].sensor_force_n = 15.0 + 1e-3 * (cycle % 10); /* a sensor that stood still would be flagged */
            signals[cable].length_m = 0.05 * cycle_s * cycle;
            signals[cable].speed_m_per_s = 0.05;
        }
        if (fric_step(compensator, &input, &output) != FRIC_RESULT_OK) {
            fprintf(stderr, "error: a pointer or a size is wrong\n");
            fric_free(compensator);
            return 1;
        }
    }

    printf("%s\n", fric_robot_name(compensator));
    for (size_t cable = 0; cable < cable_count; ++cable) {
        char status[FRIC_TEXT_SIZE];
        fric_status_text(results[cable].status, status, sizeof status);
        printf("%s: %.4f N at the platform, %.4f N of it friction, status %s\n", fric_cable_name(compensator, cable),
               results[cable].force_at_platform_n, results[cable].friction_n, status);
    }
    if (output.has_wrench) {
        const double *force_n = output.applied_wrench.force_n;
        printf("applied force %.4f %.4f %.4f N\n", force_n[0], force_n[1], force_n[2]);
    }
    fric_free(compensator);
    return 0;
}
