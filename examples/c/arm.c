/* The arm of a continuum manipulator in C: set-up, a path of bends, the tensions for it.
 *
 * Usage: arm MANIPULATOR.toml */

#include <fric.h>
#include <stdio.h>
#include <stdlib.h>

enum { MOST_DISKS = 32 };

/* Bends to go through, rad, with reversals of all sizes. */
static const double BENDS_RAD[] = {0.3, 0.9, 0.88, 0.89, 0.5, 0.52, 1.4, 1.1, 0.2};

int main(int argc, char **argv) {
    if (argc != 2) {
        fprintf(stderr, "usage: %s MANIPULATOR.toml\n", argv[0]);
        return 2;
    }
    if (fric_abi_version() != FRIC_ABI_VERSION) {
        fprintf(stderr, "libfric has ABI version %u, this program needs %d\n", fric_abi_version(), FRIC_ABI_VERSION);
        return 1;
    }

    /* Set-up may fail: it says which file, line and key, and what is allowed. */
    fric_static_model *model = NULL;
    char error[512];
    if (fric_static_model_load_file(argv[1], &model, error, sizeof error) != FRIC_RESULT_OK) {
        fprintf(stderr, "error: %s\n", error);
        return 1;
    }
    /* The first tendon is pulled with up to 3 N; the second stays slack. */
    const fric_drive drive = {.struct_size = sizeof drive, .greatest_tension_n = {3.0, 0.0}};
    if (fric_static_model_set_drive(model, &drive, error, sizeof error) != FRIC_RESULT_OK) {
        fprintf(stderr, "error: %s\n", error);
        fric_static_model_free(model);
        return 1;
    }

    fric_disk_output disks[MOST_DISKS];
    const size_t disk_count = fric_static_model_disk_count(model);
    fric_shape_output shape = {.struct_size = sizeof shape, .disks = disks, .disk_count = disk_count};
    fric_command command = {.struct_size = sizeof command};
    printf("%s\n", fric_static_model_name(model));

    /* The loop: the tension for a bend, then a step with the tension that was set or measured. Neither allocates, locks or fails on any number. */
    for (size_t place = 0; place < sizeof BENDS_RAD / sizeof *BENDS_RAD; ++place) {
        const fric_goal goal = {
            .struct_size = sizeof goal, .kind = FRIC_GOAL_BEND, .bend_rad = BENDS_RAD[place], .friction = FRIC_FRICTION_HISTORY};
        fric_result result = fric_static_model_tension_for(model, &goal, &command);
        const fric_shape_input input = {.struct_size = sizeof input,
                                        .base_tension_n = {command.base_tension_n[0], command.base_tension_n[1]},
                                        .friction = FRIC_FRICTION_HISTORY};
        if (result == FRIC_RESULT_OK) {
            result = fric_static_model_solve(model, &input, &shape);
        }
        if (result != FRIC_RESULT_OK) {
            fprintf(stderr, "error: a pointer or a size is wrong\n");
            fric_static_model_free(model);
            return 1;
        }
        const fric_disk_output *tip = &disks[disk_count - 1];
        printf("%.17g rad: %.17g N, tip at %.17g %.17g m, %.17g N of friction on the way%s%s%s\n", shape.bend_rad,
               command.base_tension_n[0], tip->position_m[0], tip->position_m[1],
               command.base_tension_n[0] - tip->tension_n[0], command.status & FRIC_COMMAND_MISSED ? ", missed" : "",
               command.status & FRIC_COMMAND_REVERSAL ? ", turns round" : "",
               command.status & FRIC_COMMAND_DEAD_BAND ? ", in the dead band" : "");
    }
    fric_static_model_free(model);
    return 0;
}
