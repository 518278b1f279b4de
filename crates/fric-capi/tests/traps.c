/* Loads and steps robots with floating-point traps on: an invalid operation, a division by zero or an overflow ends the
 * program with a signal.
 *
 * Usage: traps ROBOT.toml...
 *
 * Each robot runs by itself, then takes over the parameters of the next file. Cables run to and fro under a load that varies;
 * faults of every kind are mixed in, in the first cycle too. All numbers are finite. What lies on the stack is not: a compiler may
 * compute with it unasked. */

#define _GNU_SOURCE
#include <fenv.h>
#include <float.h>
#include <fric.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>

enum { MOST_CABLES = 64, CYCLE_COUNT = 3000, RUN_COUNT = 6, LITTER_COUNT = 2048 };

/* What a faulty sensor, encoder, and pose show. */
static const double FORCES_N[] = {0.0, -0.0, -3.0, 5e-324, 1e-300, 1e9, -1e9, 1e30, -1e30, DBL_MAX, -DBL_MAX, 15.0};
static const double LENGTHS_M[] = {0.0, 1.5, -1.5, 1e6, -1e6, 1e7, 1e30, -1e30, DBL_MAX, -DBL_MAX, 1e-300};
static const double SPEEDS_M_PER_S[] = {0.0, 1e-300, 1e6, -1e6, 1e30, DBL_MAX, -DBL_MAX};
static const double ELAPSED_CYCLES[] = {0.0, -1.0, 3.0, 1e7, DBL_MAX};
static const fric_pose POSES[] = {
    {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0, 0.0}},
    {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0, DBL_MAX}},
    {{0.0, 0.0, 0.0}, {DBL_MAX, -DBL_MAX, DBL_MAX, 1.0}},
    {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0, 1e-300}},
    {{1e6, -1e6, 1e6}, {1.0, 0.0, 0.0, 0.0}},
    {{DBL_MAX, 0.0, -DBL_MAX}, {0.0, 0.0, 0.0, 1.0}},
    /* The attachment of the example robot's first cable in its last pulley, and where the cable enters it. */
    {{0.5, 0.36, 0.555}, {0.0, 0.0, 0.0, 1.0}},
    {{0.49, 0.35, 0.55}, {0.0, 0.0, 0.0, 1.0}},
};

#define ANY_OF(values) ((values)[draw(sizeof(values) / sizeof *(values))])

static uint64_t random_state;

/* A number below `count`. */
static size_t draw(size_t count) {
    random_state = random_state * 6364136223846793005u + 1442695040888963407u;
    return (size_t)(random_state >> 33) % count;
}

/* Leaves numbers on the stack that no operation takes without a trap. */
static __attribute__((noinline)) void litter(void) {
    volatile uint64_t numbers[LITTER_COUNT];
    for (size_t number = 0; number < LITTER_COUNT; ++number) {
        numbers[number] = UINT64_C(0x7ff0000000000001);
    }
    (void)numbers;
}

/* One cable in a cycle; `fault` chooses what is the matter with it. */
static fric_cable_input signal_of(double time_s, size_t cable, size_t fault) {
    const double phase = 0.7 * (double)cable;
    const double omega = 2.0 + 0.1 * (double)cable;
    fric_cable_input signal = {.sensor_force_n = 15.0 + 10.0 * sin(0.9 * time_s + phase),
                               .length_m = 1.0 + 0.05 * sin(omega * time_s + phase),
                               .speed_m_per_s = 0.05 * omega * cos(omega * time_s + phase)};
    if (fault & 1) {
        signal.sensor_force_n = ANY_OF(FORCES_N);
    }
    if (fault & 2) {
        signal.length_m = ANY_OF(LENGTHS_M);
    }
    if (fault & 4) {
        signal.speed_m_per_s = ANY_OF(SPEEDS_M_PER_S);
    }
    if (fault & 8) {
        /* Frozen, or slack while it moves. */
        signal.sensor_force_n = time_s < 2.0 ? 12.0 : -1.0;
    }
    return signal;
}

/* Some seconds of a robot's life; gives the sum of the forces, N. */
static double run(fric_compensator *compensator, uint64_t seed) {
    fric_cable_input signals[MOST_CABLES];
    fric_cable_output results[MOST_CABLES];
    size_t faults[MOST_CABLES] = {0};
    const size_t cable_count = fric_cable_count(compensator);
    const double cycle_s = fric_cycle_s(compensator);
    double sum_n = 0.0;
    random_state = seed;
    for (int cycle = 0; cycle < CYCLE_COUNT; ++cycle) {
        const double time_s = cycle_s * cycle;
        for (size_t cable = 0; cable < cable_count; ++cable) {
            /* The first run has no fault in its first second, the others have one in their first cycle. */
            const int may_fail = seed != 0 || cycle > 1000;
            if (may_fail && (cycle == 0 || draw(300) == 0)) {
                faults[cable] = draw(16);
            } else if (draw(20) == 0) {
                faults[cable] = 0;
            }
            signals[cable] = signal_of(time_s, cable, faults[cable]);
        }
        const double tilt = 0.05 * sin(1.3 * time_s);
        const fric_pose at = {.position_m = {0.05 * sin(2.0 * time_s), 0.03 * cos(1.7 * time_s), 0.02},
                              .orientation_xyzw = {tilt, 0.0, 0.0, sqrt(1.0 - tilt * tilt)}};
        const fric_pose *pose = &at;
        if (seed != 0 && draw(20) == 0) {
            pose = draw(4) == 0 ? NULL : &ANY_OF(POSES);
        }
        const fric_input input = {.struct_size = sizeof input,
                                  .cables = signals,
                                  .cable_count = cable_count,
                                  .pose = pose,
                                  .elapsed_cycles = seed != 0 && draw(50) == 0 ? ANY_OF(ELAPSED_CYCLES) : 1.0};
        fric_output output = {.struct_size = sizeof output, .cables = results, .cable_count = cable_count};
        litter();
        if (fric_step(compensator, &input, &output) != FRIC_RESULT_OK) {
            exit(1);
        }
        for (size_t cable = 0; cable < cable_count; ++cable) {
            sum_n += 1e-9 * results[cable].force_at_platform_n;
        }
    }
    return sum_n;
}

static void check(fric_result result, const char *error) {
    if (result != FRIC_RESULT_OK) {
        fprintf(stderr, "error: %s\n", error);
        exit(1);
    }
}

int main(int argc, char **argv) {
    char error[512] = "";
    double sum_n = 0.0;
    feclearexcept(FE_ALL_EXCEPT);
    feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW);
    for (int file = 1; file < argc; ++file) {
        fprintf(stderr, "%s\n", argv[file]);
        fric_compensator *compensator = NULL;
        check(fric_load_file(argv[file], &compensator, error, sizeof error), error);
        for (uint64_t seed = 0; seed < RUN_COUNT; ++seed) {
            sum_n += run(compensator, seed);
            fric_reset(compensator);
        }
        if (file + 1 < argc) {
            sum_n += run(compensator, RUN_COUNT);
            check(fric_change_file(compensator, argv[file + 1], 1.0, error, sizeof error), error);
            sum_n += run(compensator, RUN_COUNT + 1);
        }
        fric_free(compensator);
    }
    fedisableexcept(FE_ALL_EXCEPT);
    printf("%.3f\n", sum_n);
    return 0;
}
