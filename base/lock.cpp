#include "base/lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "base/error.h"
#include "base/file.h"

namespace gonogo {

FolderLock::FolderLock(const std::filesystem::path& folder) : fd_(-1) {
  create_folder(folder);
  const std::filesystem::path file = folder / ".lock";
  fd_ = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (fd_ < 0)
    throw DeviceError(folder.string() + ": cannot write there: " + std::strerror(errno) +
                      "; choose another folder or fix its permissions");
  if (::flock(fd_, LOCK_EX | LOCK_NB) == 0) return;
  const int error = errno;
  ::close(fd_);
  if (error == EWOULDBLOCK)
    throw InputError(folder.string() + ": another run is using this folder; wait for it or choose another folder");
  throw DeviceError(file.string() + ": cannot be locked: " + std::strerror(error));
}

FolderLock::~FolderLock() { ::close(fd_); }

}  // namespace gonogo
