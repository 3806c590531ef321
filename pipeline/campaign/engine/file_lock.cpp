#include "pipeline/campaign/engine/file_lock.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "base/error.h"

namespace gonogo::campaign {
namespace {

struct flock whole_file(short type) {
  struct flock lock {};
  lock.l_type = type;
  lock.l_whence = SEEK_SET;
  return lock;
}

}  // namespace

FileLock::~FileLock() {
  if (fd_ >= 0) ::close(fd_);
}

FileLock::FileLock(FileLock&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}

std::optional<FileLock> FileLock::take(const std::filesystem::path& path, Kind kind) {
  FileLock result;
  result.fd_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (result.fd_ < 0)
    throw InputError(path.parent_path().string() + ": cannot write here (" + std::strerror(errno) +
                     "); fix its permissions or choose another folder");
  struct flock lock = whole_file(kind == Kind::exclusive ? F_WRLCK : F_RDLCK);
  if (::fcntl(result.fd_, F_OFD_SETLK, &lock) == 0) return result;
  if (errno == EAGAIN || errno == EACCES) return std::nullopt;
  throw DeviceError(path.string() + ": this filesystem has no locks (" + std::strerror(errno) +
                    "), and two campaigns could mix; choose a folder on another one");
}

std::optional<FileLock::Kind> FileLock::held(const std::filesystem::path& path) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return std::nullopt;
  struct flock lock = whole_file(F_WRLCK);
  const bool known = ::fcntl(fd, F_OFD_GETLK, &lock) == 0;
  ::close(fd);
  if (!known || lock.l_type == F_UNLCK) return std::nullopt;
  return lock.l_type == F_RDLCK ? Kind::shared : Kind::exclusive;
}

}  // namespace gonogo::campaign
