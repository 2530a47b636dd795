/* Preloaded into impinge by reliability_test.py: counts the calls that change files below a directory and makes one of
 * them fail. Environment:
 *   FAULT_DIRECTORY  absolute; calls on other files go through uncounted
 *   FAULT_AT         number of the call, from 1
 *   FAULT_ERROR      0: the process kills itself just before the call; else this and later calls that need space or write
 *                    fail with that errno
 *   FAULT_RANK       rank of Open MPI that counts; empty: every one
 */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/uio.h>
#include <unistd.h>

static const char* setting(const char* name, const char* fallback) {
  const char* value = getenv(name);
  return value && *value ? value : fallback;
}

/* Whether the call, on a path or on a descriptor, is to fail. */
static int fails(const char* path, int descriptor) {
  static int count = 0;
  const char* directory = setting("FAULT_DIRECTORY", NULL);
  char resolved[PATH_MAX];
  if (!directory) return 0;
  const char* rank = setting("FAULT_RANK", NULL);
  if (rank && strcmp(rank, setting("OMPI_COMM_WORLD_RANK", "0")) != 0) return 0;
  if (!path) {
    char link[64];
    snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
    const ssize_t length = readlink(link, resolved, sizeof resolved - 1);
    if (length < 0) return 0;
    resolved[length] = '\0';
    path = resolved;
  } else if (path[0] != '/') {
    char here[PATH_MAX];
    if (!getcwd(here, sizeof here) || snprintf(resolved, sizeof resolved, "%s/%s", here, path) >= PATH_MAX) return 0;
    path = resolved;
  }
  if (strncmp(path, directory, strlen(directory)) != 0) return 0;
  ++count;
  const int at = atoi(setting("FAULT_AT", "0"));
  const int error = atoi(setting("FAULT_ERROR", "0"));
  if (at == 0 || count < at) return 0;
  if (error == 0) kill(getpid(), SIGKILL);
  errno = error;
  return 1;
}

#define REAL(name) ((__typeof__(&name))dlsym(RTLD_NEXT, #name))

#define ON_DESCRIPTOR(type, name, parameters, arguments) \
  type name parameters {                                 \
    if (fails(NULL, descriptor)) return -1;              \
    return REAL(name) arguments;                         \
  }
ON_DESCRIPTOR(ssize_t, write, (int descriptor, const void* data, size_t size), (descriptor, data, size))
ON_DESCRIPTOR(ssize_t, pwrite, (int descriptor, const void* data, size_t size, off_t at), (descriptor, data, size, at))
ON_DESCRIPTOR(ssize_t, pwrite64, (int descriptor, const void* data, size_t size, off64_t at),
              (descriptor, data, size, at))
ON_DESCRIPTOR(ssize_t, writev, (int descriptor, const struct iovec* parts, int count), (descriptor, parts, count))
ON_DESCRIPTOR(ssize_t, pwritev, (int descriptor, const struct iovec* parts, int count, off_t at),
              (descriptor, parts, count, at))
ON_DESCRIPTOR(ssize_t, pwritev64, (int descriptor, const struct iovec* parts, int count, off64_t at),
              (descriptor, parts, count, at))
ON_DESCRIPTOR(int, fsync, (int descriptor), (descriptor))
ON_DESCRIPTOR(int, ftruncate, (int descriptor, off_t size), (descriptor, size))
ON_DESCRIPTOR(int, ftruncate64, (int descriptor, off64_t size), (descriptor, size))

/* A full disk does not keep anybody from removing files or closing them: these die at most. */
static void may_die(const char* path, int descriptor) { (void)fails(path, descriptor); }
int unlink(const char* path) {
  may_die(path, -1);
  return REAL(unlink)(path);
}
int remove(const char* path) {
  may_die(path, -1);
  return REAL(remove)(path);
}
int close(int descriptor) {
  may_die(NULL, descriptor);
  return REAL(close)(descriptor);
}

int rename(const char* from, const char* to) {
  if (fails(to, -1)) return -1;
  return REAL(rename)(from, to);
}

#define OPEN(name)                                   \
  int name(const char* path, int flags, ...) {       \
    mode_t mode = 0;                                 \
    if (flags & O_CREAT) {                           \
      va_list rest;                                  \
      va_start(rest, flags);                         \
      mode = va_arg(rest, mode_t);                   \
      va_end(rest);                                  \
      if (fails(path, -1)) return -1;                \
    } else {                                         \
      may_die(path, -1);                             \
    }                                                \
    return REAL(name)(path, flags, mode);            \
  }
OPEN(open)
OPEN(open64)

#define FOPEN(name)                                  \
  FILE* name(const char* path, const char* mode) {   \
    if (mode[0] == 'r') may_die(path, -1);           \
    else if (fails(path, -1)) return NULL;           \
    return REAL(name)(path, mode);                   \
  }
FOPEN(fopen)
FOPEN(fopen64)
