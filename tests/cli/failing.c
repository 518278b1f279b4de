// Loaded into the program with LD_PRELOAD: the FRIC_FAIL_AT-th call of a kind (FRIC_FAIL) fails once.
//
// System calls are caught where the kernel takes them (seccomp), not in libc: `tempfile` renames without libc.
// The file FRIC_FAIL_SEEN gets two numbers: how many calls of the kind there were, and whether one was failed.
// Counted is what happens once the loader has read the libraries, this one last.
#define _GNU_SOURCE
#include <errno.h>
#include <fcntl.h>
#include <linux/audit.h>
#include <linux/filter.h>
#include <linux/magic.h>
#include <linux/seccomp.h>
#include <signal.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/vfs.h>
#include <ucontext.h>
#include <unistd.h>

// In the sixth argument, which none of these calls has: let this one pass.
#define PASS 0x66726963L
#define END (-1)
#define LENGTH(array) (sizeof(array) / sizeof(*(array)))

static const int WRITES[] = {SYS_write, SYS_writev, SYS_pwrite64, SYS_pwritev, SYS_ftruncate, SYS_fallocate,
                             SYS_sendfile, END};
static const int SHORT_WRITES[] = {SYS_write, END};
static const int READS[] = {SYS_pread64, SYS_readv, SYS_preadv, SYS_read, END};
static const int OPENS[] = {SYS_open, SYS_openat, SYS_creat, END};
static const int RENAMES[] = {SYS_rename, SYS_renameat, SYS_renameat2, SYS_link, SYS_linkat, END};
static const int SYNCS[] = {SYS_fsync, SYS_fdatasync, SYS_sync_file_range, END};
static const int LOOKS[] = {SYS_stat, SYS_lstat, SYS_newfstatat, SYS_statx, SYS_readlink, SYS_lseek, END};

static const struct kind {
    const char *name;
    const int *calls;
    int error;
} KINDS[] = {
    {"write", WRITES, ENOSPC}, {"short", SHORT_WRITES, ENOSPC}, {"read", READS, EIO},
    {"open", OPENS, EMFILE},   {"rename", RENAMES, EIO},        {"sync", SYNCS, EIO},
    {"look", LOOKS, EIO},      {"memory", NULL, ENOMEM},
};

static const struct kind *kind;
static uint64_t fail_at;
static struct {
    uint64_t calls, failed;
} nowhere, *seen = &nowhere;

// Whether this call is the one.
static int is_due(void) {
    if (__atomic_add_fetch(&seen->calls, 1, __ATOMIC_RELAXED) != fail_at) return 0;
    seen->failed = 1;
    return 1;
}

static long call(const greg_t *registers, long third) {
    register long r10 __asm__("r10") = registers[REG_R10];
    register long r8 __asm__("r8") = registers[REG_R8];
    register long r9 __asm__("r9") = PASS;
    long result;
    __asm__ volatile("syscall"
                     : "=a"(result)
                     : "a"(registers[REG_RAX]), "D"(registers[REG_RDI]), "S"(registers[REG_RSI]), "d"(third),
                       "r"(r10), "r"(r8), "r"(r9)
                     : "rcx", "r11", "memory");
    return result;
}

// Not counted are reads of pipes, as the thread that waits for Ctrl-C sits in one, and what glibc reads of the
// kernel's settings: malloc does so when a thread gives memory back, which differs from run to run.
static int is_counted(const greg_t *registers, long number) {
    struct stat status;
    struct statfs system;
    int file = (int)registers[REG_RDI];
    if (kind->calls == READS)
        return fstat(file, &status) == 0 && S_ISREG(status.st_mode) && fstatfs(file, &system) == 0 &&
               system.f_type != PROC_SUPER_MAGIC;
    if (kind->calls != OPENS) return 1;
    const char *path = (const char *)registers[number == SYS_openat ? REG_RSI : REG_RDI];
    return strncmp(path, "/proc/", 6) != 0;
}

static void on_call(int signal, siginfo_t *info, void *context) {
    (void)signal;
    static int full = -1; // the file of a short write, whose next write fails
    int before = errno;
    greg_t *registers = ((ucontext_t *)context)->uc_mcontext.gregs;
    registers[REG_RAX] = info->si_syscall;
    int file = (int)registers[REG_RDI];
    long third = registers[REG_RDX];
    long result;
    if (full >= 0 && full == file) {
        full = -1;
        result = -ENOSPC;
    } else if (!is_counted(registers, info->si_syscall) || !is_due()) {
        result = call(registers, third);
    } else if (kind->calls == SHORT_WRITES && third > 1) {
        full = file;
        result = call(registers, third / 2);
    } else {
        result = -kind->error;
    }
    registers[REG_RAX] = result;
    errno = before;
}

// The kernel hands the calls of the kind to on_call.
static void watch(const int *calls) {
    struct sock_filter filter[64];
    size_t length = 0;
    filter[length++] = (struct sock_filter)BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, args[5]));
    filter[length++] = (struct sock_filter)BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, PASS, 0, 1);
    filter[length++] = (struct sock_filter)BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
    filter[length++] = (struct sock_filter)BPF_STMT(BPF_LD | BPF_W | BPF_ABS, offsetof(struct seccomp_data, nr));
    for (; *calls != END; calls++) {
        filter[length++] = (struct sock_filter)BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, (unsigned)*calls, 0, 1);
        filter[length++] = (struct sock_filter)BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRAP);
    }
    filter[length++] = (struct sock_filter)BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW);
    struct sigaction action = {.sa_sigaction = on_call, .sa_flags = SA_SIGINFO | SA_NODEFER};
    struct sock_fprog program = {(unsigned short)length, filter};
    if (sigaction(SIGSYS, &action, NULL) || prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) ||
        prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &program))
        _exit(99);
}

__attribute__((constructor)) static void begin(void) {
    const char *name = getenv("FRIC_FAIL"), *path = getenv("FRIC_FAIL_SEEN"), *at = getenv("FRIC_FAIL_AT");
    if (!name || !path || !at) _exit(99);
    int file = open(path, O_RDWR | O_CREAT | O_TRUNC, 0600);
    void *shared = MAP_FAILED;
    if (file >= 0 && !ftruncate(file, sizeof *seen))
        shared = mmap(NULL, sizeof *seen, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    if (shared == MAP_FAILED) _exit(99);
    close(file);
    for (size_t i = 0; i < LENGTH(KINDS); i++)
        if (!strcmp(KINDS[i].name, name)) kind = &KINDS[i];
    if (!kind) _exit(99);
    seen = shared;
    fail_at = strtoull(at, NULL, 10);
    if (kind->calls) watch(kind->calls);
}

static int is_refused(void) {
    if (!kind || kind->calls || !is_due()) return 0;
    errno = ENOMEM;
    return 1;
}

void *__libc_malloc(size_t);
void *__libc_calloc(size_t, size_t);
void *__libc_realloc(void *, size_t);
void *__libc_memalign(size_t, size_t);

void *malloc(size_t size) { return is_refused() ? NULL : __libc_malloc(size); }
void *calloc(size_t count, size_t size) { return is_refused() ? NULL : __libc_calloc(count, size); }
void *realloc(void *old, size_t size) { return is_refused() ? NULL : __libc_realloc(old, size); }
void *memalign(size_t align, size_t size) { return is_refused() ? NULL : __libc_memalign(align, size); }
void *aligned_alloc(size_t align, size_t size) { return memalign(align, size); }
int posix_memalign(void **place, size_t align, size_t size) {
    void *memory = memalign(align, size);
    if (!memory) return ENOMEM;
    *place = memory;
    return 0;
}
