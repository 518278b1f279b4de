/* Loads robot files, and changes to them, on a thread with a stack of a given size; and manipulator files, which are solved.
 *
 * Usage: stack BYTES FILE.toml...
 *
 * A stack that is too small ends the program with a signal. */

#define _GNU_SOURCE
#include <fric.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>

static char error[512];

enum { MOST_DISKS = 32 };

/* One of each call of the loop, long steps and a goal out of reach among them. */
static void solve(fric_static_model *model) {
    fric_disk_output disks[MOST_DISKS];
    fric_disk_input measured[MOST_DISKS] = {{{0.0, 0.0}}};
    const size_t disk_count = fric_static_model_disk_count(model);
    fric_shape_output shape = {.struct_size = sizeof shape, .disks = disks, .disk_count = disk_count};
    fric_command command = {.struct_size = sizeof command};
    for (uint32_t friction = FRIC_FRICTION_HISTORY; friction <= FRIC_FRICTION_MEASURED; ++friction) {
        for (int step = 0; step < 4; ++step) {
            const fric_shape_input input = {.struct_size = sizeof input,
                                            .base_tension_n = {0.3 * (step % 3), 0.1},
                                            .measured = measured,
                                            .measured_count = disk_count,
                                            .friction = friction};
            const fric_goal goal = {.struct_size = sizeof goal,
                                    .bend_rad = 0.3 * step * step,
                                    .tip_m = {0.1, 0.1},
                                    .kind = step % 2 == 0 ? FRIC_GOAL_BEND : FRIC_GOAL_TIP,
                                    .friction = friction};
            if (fric_static_model_solve(model, &input, &shape) != FRIC_RESULT_OK ||
                fric_static_model_tension_for(model, &goal, &command) != FRIC_RESULT_OK) {
                exit(1);
            }
        }
    }
}

static void *load(void *path) {
    fric_static_model *model = NULL;
    if (fric_static_model_load_file(path, &model, error, sizeof error) == FRIC_RESULT_OK) {
        solve(model);
        fric_static_model_free(model);
        return NULL;
    }
    fric_compensator *compensator = NULL;
    if (fric_load_file(path, &compensator, error, sizeof error) == FRIC_RESULT_OK) {
        fric_change_file(compensator, path, 1.0, error, sizeof error);
    }
    fric_free(compensator);
    return NULL;
}

int main(int argc, char **argv) {
    pthread_attr_t attributes;
    if (argc < 3 || pthread_attr_init(&attributes) != 0 ||
        pthread_attr_setstacksize(&attributes, strtoul(argv[1], NULL, 10)) != 0) {
        fprintf(stderr, "usage: stack BYTES FILE.toml...\n");
        return 1;
    }
    for (int file = 2; file < argc; ++file) {
        pthread_t thread;
        if (pthread_create(&thread, &attributes, load, argv[file]) != 0 || pthread_join(thread, NULL) != 0) {
            return 1;
        }
        if (error[0] != '\0') {
            fprintf(stderr, "error: %s\n", error);
            return 1;
        }
    }
    return 0;
}
