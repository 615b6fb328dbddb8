// Preloaded into a program, makes its n-th call of one kind fail, as on a full disk or without memory.
//   MICA_FAIL_CALL   open, write, fsync, rename or new
//   MICA_FAIL_AT     n, from 1; 0: none fails
//   MICA_FAIL_BELOW  folder of the files that are meant: those of drivers are left alone
//   MICA_FAIL_COUNT  descriptor on which the number of calls is written when the program ends
#ifndef _GNU_SOURCE
#define _GNU_SOURCE
#endif
#include <dlfcn.h>
#include <fcntl.h>
#include <link.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>

extern "C" void* __libc_malloc(std::size_t);

namespace {

std::atomic<bool> in_main{false};
std::atomic<long> calls{0};

const char* setting(const char* name) {
  const char* value = std::getenv(name);
  return value ? value : "";
}

/// Counts a call of this kind; whether it is the one that fails.
bool fails(const char* kind) {
  static const char* const wanted = setting("MICA_FAIL_CALL");
  static const long at = std::atol(setting("MICA_FAIL_AT"));
  return in_main && std::strcmp(kind, wanted) == 0 && ++calls == at;
}

bool is_meant(const char* path) {
  static const char* const below = setting("MICA_FAIL_BELOW");
  if (path[0] != '/') return true;  // the program works there
  return std::strncmp(path, below, std::strlen(below)) == 0;
}

bool is_meant(int descriptor) {
  char link[64], path[4096];
  std::snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  const ssize_t length = readlink(link, path, sizeof path - 1);
  if (length < 0) return false;
  path[length] = 0;
  return path[0] == '/' && is_meant(path);
}

template <typename Function>
Function real(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

/// Whether an address is in the program itself, and not in a library.
bool is_own(const void* address) {
  static std::uintptr_t first = 0, last = 0;
  if (last == 0)
    dl_iterate_phdr(
        [](dl_phdr_info* info, std::size_t, void*) {
          for (int n = 0; n < info->dlpi_phnum; ++n) {
            const auto& header = info->dlpi_phdr[n];
            if (header.p_type != PT_LOAD || !(header.p_flags & PF_X)) continue;
            first = info->dlpi_addr + header.p_vaddr;
            last = first + header.p_memsz;
          }
          return 1;  // the first is the program
        },
        nullptr);
  const auto value = reinterpret_cast<std::uintptr_t>(address);
  return first <= value && value < last;
}

int no_space() {
  errno = ENOSPC;
  return -1;
}

int (*real_main)(int, char**, char**);

int counted_main(int argc, char** argv, char** environment) {
  in_main = true;
  const int code = real_main(argc, argv, environment);
  in_main = false;
  if (const int descriptor = std::atoi(setting("MICA_FAIL_COUNT")); descriptor > 0)
    dprintf(descriptor, "%ld\n", calls.load());
  return code;
}

}  // namespace

extern "C" {

int __libc_start_main(int (*main)(int, char**, char**), int argc, char** argv, void (*init)(), void (*fini)(),
                      void (*rtld_fini)(), void* stack_end) {
  real_main = main;
  return real<decltype(&__libc_start_main)>("__libc_start_main")(counted_main, argc, argv, init, fini,
                                                                 rtld_fini, stack_end);
}

int open(const char* path, int flags, ...) {
  std::va_list arguments;
  va_start(arguments, flags);
  const mode_t mode = flags & O_CREAT ? va_arg(arguments, mode_t) : 0;
  va_end(arguments);
  if (is_meant(path) && fails("open")) return errno = flags & O_CREAT ? ENOSPC : EIO, -1;
  return real<int (*)(const char*, int, ...)>("open")(path, flags, mode);
}
int open64(const char* path, int flags, ...) __attribute__((alias("open")));

std::FILE* fopen(const char* path, const char* mode) {
  if (is_meant(path) && fails("open")) return errno = EIO, nullptr;
  return real<decltype(&fopen)>("fopen")(path, mode);
}
std::FILE* fopen64(const char* path, const char* mode) __attribute__((alias("fopen")));

ssize_t write(int descriptor, const void* bytes, std::size_t count) {
  if (is_meant(descriptor) && fails("write")) return no_space();
  return real<decltype(&write)>("write")(descriptor, bytes, count);
}

int fsync(int descriptor) {
  if (is_meant(descriptor) && fails("fsync")) return no_space();
  return real<decltype(&fsync)>("fsync")(descriptor);
}

int rename(const char* from, const char* to) {
  if (is_meant(to) && fails("rename")) return no_space();
  return real<decltype(&rename)>("rename")(from, to);
}

void* malloc(std::size_t size) {
  if (in_main && is_own(__builtin_return_address(0)) && fails("new")) return errno = ENOMEM, nullptr;
  return __libc_malloc(size);
}

}  // extern "C"

void* operator new(std::size_t size) {
  if (in_main && is_own(__builtin_return_address(0)) && fails("new")) throw std::bad_alloc();
  void* const place = __libc_malloc(size ? size : 1);
  if (place == nullptr) throw std::bad_alloc();
  return place;
}
