#include "base/lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "base/error.h"
#include "base/file.h"

namespace gonogo {

namespace {

/// The locked file, or -1 when another process holds it.
int locked(const std::filesystem::path& folder) {
  create_folder(folder);
  const std::filesystem::path file = folder / ".lock";
  const int fd = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (fd < 0)
    throw DeviceError(folder.string() + ": cannot write there: " + std::strerror(errno) +
                      "; choose another folder or fix its permissions");
  if (::flock(fd, LOCK_EX | LOCK_NB) == 0) return fd;
  const int error = errno;
  ::close(fd);
  if (error == EWOULDBLOCK) return -1;
  throw DeviceError(file.string() + ": cannot be locked: " + std::strerror(error));
}

}  // namespace

FolderLock::FolderLock(const std::filesystem::path& folder) : fd_(locked(folder)) {
  if (fd_ < 0)
    throw InputError(folder.string() + ": another run is using this folder; wait for it or choose another folder");
}

std::unique_ptr<FolderLock> FolderLock::if_free(const std::filesystem::path& folder) {
  const int fd = locked(folder);
  return fd < 0 ? nullptr : std::unique_ptr<FolderLock>(new FolderLock(Opened{fd}));
}

FolderLock::~FolderLock() { ::close(fd_); }

}  // namespace gonogo
