// Preloaded into a program, this makes every filesystem one without locks, as some shared ones are.
#include <dlfcn.h>
#include <fcntl.h>

#include <cerrno>
#include <cstdarg>

namespace {

int without_locks(const char* name, int fd, int command, void* argument) {
  if (command == F_OFD_SETLK) {
    errno = ENOLCK;
    return -1;
  }
  return reinterpret_cast<int (*)(int, int, ...)>(dlsym(RTLD_NEXT, name))(fd, command, argument);
}

}  // namespace

extern "C" int fcntl(int fd, int cmd, ...) {
  std::va_list rest;
  va_start(rest, cmd);
  void* const argument = va_arg(rest, void*);
  va_end(rest);
  return without_locks("fcntl", fd, cmd, argument);
}

extern "C" int fcntl64(int fd, int cmd, ...) {
  std::va_list rest;
  va_start(rest, cmd);
  void* const argument = va_arg(rest, void*);
  va_end(rest);
  return without_locks("fcntl64", fd, cmd, argument);
}
