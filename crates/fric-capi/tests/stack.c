/* Loads robot files, and changes to them, on a thread with a stack of a given size.
 *
 * Usage: stack BYTES ROBOT.toml...
 *
 * A stack that is too small ends the program with a signal. */

#define _GNU_SOURCE
#include <fric.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>

static char error[512];

static void *load(void *path) {
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
        fprintf(stderr, "usage: stack BYTES ROBOT.toml...\n");
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
