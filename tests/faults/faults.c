// For LD_PRELOAD: fails one system call or allocation of a process, so that what a command does then can be tried.
//
// CAMBER_FAULT=KIND:N fails the N-th call of a kind, counted from 1; CAMBER_FAULT=count fails none. Kinds:
//   open    a file is opened for reading or writing
//   read    bytes are read from a regular file
//   write   bytes are written to a regular file
//   rename, fsync
//   mmap    memory is asked for from the system, or a file is mapped
//   malloc  an allocation of at least CAMBER_FAULT_BYTES (65536); not those of libblosc, which uses what it did not get
//   thread  a thread is started
// Files of the system (/proc, /usr, ...) and standard output and error do not count. CAMBER_FAULT_LOG names a file that
// gets a line "KIND N PATH" for each counted call, with "!" before it where it failed. scripts/try-faults uses this.
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <stdarg.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

enum kind { kOpen, kRead, kWrite, kRename, kFsync, kMmap, kMalloc, kThread, kKinds };
static const char* const names[kKinds] = {"open", "read", "write", "rename", "fsync", "mmap", "malloc", "thread"};

static atomic_long counts[kKinds];
static int asked = -1;  // kind that fails; -1: none
static long asked_number = 0;
static size_t least_bytes = 65536;
static int log_file = -1;
static int ready = 0;  // before main, the loader and the libraries are on their own

__attribute__((constructor)) static void start(void) {
  const char* fault = getenv("CAMBER_FAULT");
  const char* path = getenv("CAMBER_FAULT_LOG");
  const char* bytes = getenv("CAMBER_FAULT_BYTES");
  if (!fault) return;
  if (bytes) least_bytes = strtoul(bytes, NULL, 10);
  if (path) log_file = (int)syscall(SYS_openat, AT_FDCWD, path, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  for (int k = 0; k < kKinds; ++k) {
    const size_t length = strlen(names[k]);
    if (strncmp(fault, names[k], length) != 0 || fault[length] != ':') continue;
    asked = k;
    asked_number = strtol(fault + length + 1, NULL, 10);
  }
  ready = 1;
}

// No allocation and no call that is counted: this runs within both.
static void note(enum kind k, long number, int failed, const char* path) {
  if (log_file < 0) return;
  char line[4400];
  const int length = snprintf(line, sizeof line, "%s%s %ld %.4096s\n", failed ? "!" : "", names[k], number, path);
  syscall(SYS_write, log_file, line, (size_t)length);
}

/// True: this call fails.
static int fails(enum kind k, const char* path) {
  if (!ready) return 0;
  const long number = atomic_fetch_add(&counts[k], 1) + 1;
  const int failed = (int)k == asked && number == asked_number;
  if (failed || asked < 0) note(k, number, failed, path);
  return failed;
}

static int of_system(const char* path) {
  static const char* const folders[] = {"/proc/", "/sys/", "/dev/", "/usr/", "/etc/", "/lib", "/var/"};
  if (strncmp(path, "/proc/self/fd/", 14) == 0) return 0;  // a part that is open already
  for (size_t i = 0; i < sizeof folders / sizeof *folders; ++i)
    if (strncmp(path, folders[i], strlen(folders[i])) == 0) return 1;
  return 0;
}

static const char* name_of(int file, char* out, size_t bytes) {
  char link[64];
  snprintf(link, sizeof link, "/proc/self/fd/%d", file);
  const ssize_t length = readlink(link, out, bytes - 1);
  out[length < 0 ? 0 : length] = '\0';
  return out;
}

static int counted_file(int file) {
  struct stat about;
  return file > STDERR_FILENO && file != log_file && fstat(file, &about) == 0 && S_ISREG(about.st_mode);
}

#define REAL(function) ((__typeof__(&function))dlsym(RTLD_NEXT, #function))

static int open_fails(const char* path) {
  if (of_system(path) || !fails(kOpen, path)) return 0;
  errno = EIO;
  return 1;
}

#define OPEN(function)                                     \
  int function(const char* path, int flags, ...) {         \
    va_list more;                                          \
    va_start(more, flags);                                 \
    const mode_t mode = va_arg(more, mode_t);              \
    va_end(more);                                          \
    return open_fails(path) ? -1 : REAL(function)(path, flags, mode); \
  }
OPEN(open)
OPEN(open64)

#define FOPEN(function)                                    \
  FILE* function(const char* path, const char* mode) {     \
    return open_fails(path) ? NULL : REAL(function)(path, mode); \
  }
FOPEN(fopen)
FOPEN(fopen64)

static int write_fails(int file) {
  if (!ready || !counted_file(file)) return 0;
  char name[4096];
  if (!fails(kWrite, name_of(file, name, sizeof name))) return 0;
  errno = ENOSPC;
  return 1;
}
ssize_t write(int file, const void* from, size_t bytes) {
  return write_fails(file) ? -1 : syscall(SYS_write, file, from, bytes);
}
ssize_t writev(int file, const struct iovec* pieces, int count) {
  return write_fails(file) ? -1 : syscall(SYS_writev, file, pieces, count);
}

ssize_t read(int file, void* to, size_t bytes) {
  char name[4096];
  if (ready && counted_file(file) && !of_system(name_of(file, name, sizeof name)) && fails(kRead, name))
    return errno = EIO, -1;
  return syscall(SYS_read, file, to, bytes);
}

int rename(const char* from, const char* to) {
  if (fails(kRename, to)) return errno = EIO, -1;
  return REAL(rename)(from, to);
}

int fsync(int file) {
  char name[4096];
  if (fails(kFsync, name_of(file, name, sizeof name))) return errno = EIO, -1;
  return (int)syscall(SYS_fsync, file);
}

#define MMAP(function)                                                                     \
  void* function(void* at, size_t bytes, int protection, int flags, int file, off_t from) { \
    if (fails(kMmap, "memory")) return errno = ENOMEM, MAP_FAILED;                         \
    return (void*)syscall(SYS_mmap, at, bytes, protection, flags, file, from);             \
  }
MMAP(mmap)
MMAP(mmap64)

#define CALLER __builtin_return_address(0)
extern void* __libc_malloc(size_t);
extern void* __libc_calloc(size_t, size_t);
extern void* __libc_realloc(void*, size_t);
extern void* __libc_memalign(size_t, size_t);

static int of_blosc(const void* caller) {
  Dl_info library;
  return dladdr(caller, &library) && library.dli_fname && strstr(library.dli_fname, "libblosc");
}

static int memory_fails(size_t bytes, const void* caller) {
  if (!ready || bytes < least_bytes || of_blosc(caller) || !fails(kMalloc, "memory")) return 0;
  errno = ENOMEM;
  return 1;
}
void* malloc(size_t bytes) { return memory_fails(bytes, CALLER) ? NULL : __libc_malloc(bytes); }
void* calloc(size_t count, size_t bytes) { return memory_fails(count * bytes, CALLER) ? NULL : __libc_calloc(count, bytes); }
void* realloc(void* old, size_t bytes) { return memory_fails(bytes, CALLER) ? NULL : __libc_realloc(old, bytes); }
void* memalign(size_t alignment, size_t bytes) { return memory_fails(bytes, CALLER) ? NULL : __libc_memalign(alignment, bytes); }
void* aligned_alloc(size_t alignment, size_t bytes) { return memory_fails(bytes, CALLER) ? NULL : __libc_memalign(alignment, bytes); }
int posix_memalign(void** out, size_t alignment, size_t bytes) {
  void* const place = memory_fails(bytes, CALLER) ? NULL : __libc_memalign(alignment, bytes);
  if (!place) return ENOMEM;
  *out = place;
  return 0;
}

int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*body)(void*), void* argument) {
  if (fails(kThread, "thread")) return EAGAIN;
  return REAL(pthread_create)(thread, attributes, body, argument);
}
