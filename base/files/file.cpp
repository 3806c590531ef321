#include "base/files/file.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <memory>
#include <sstream>
#include <utility>

#include "base/error.h"
#include "base/progress.h"

namespace gonogo {

namespace fs = std::filesystem;
namespace {

std::string reason() { return std::strerror(errno); }

void flush_to_disk(const fs::path& path) {
  const int fd = ::open(path.c_str(), O_RDONLY);
  if (fd < 0) throw DeviceError(path.string() + ": cannot open to flush: " + reason());
  const int status = ::fsync(fd);
  const std::string why = status == 0 ? "" : reason();
  ::close(fd);
  if (status != 0) throw DeviceError(path.string() + ": cannot flush to disk: " + why);
}

[[noreturn]] void refuse(const fs::path& path, const std::string& message) {
  throw PlacedInputError(path.string() + ": " + message, {.file = path.string()});
}

fs::path folder_of(const fs::path& path) { return path.has_parent_path() ? path.parent_path() : fs::path("."); }

/// What another program writes into a pipe. Answers Ctrl-C, and waits at most a minute for the next bytes.
std::string read_pipe(const fs::path& path) {
  constexpr int step = 50, most = 60000;  // [ms]
  const int fd = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (fd < 0) refuse(path, "cannot be read: " + reason());
  const std::unique_ptr<const int, void (*)(const int*)> owner(&fd, [](const int* p) { ::close(*p); });
  std::string text;
  std::array<char, 65536> part{};
  for (int waited = 0; waited < most; waited += step) {
    stop_if_cancelled();
    struct pollfd ready = {fd, POLLIN, 0};
    if (::poll(&ready, 1, step) <= 0) continue;
    const ssize_t n = ::read(fd, part.data(), part.size());
    if (n == 0 && !text.empty()) return text;
    if (n <= 0) {  // no writer yet
      ::usleep(step * 1000);
      continue;
    }
    text.append(part.data(), std::size_t(n));
    waited = 0;
  }
  refuse(path, "is a pipe into which nobody wrote for a minute; give a file");
}

}  // namespace

std::string read_file(const fs::path& path) {
  std::error_code ec;
  if (!fs::exists(path, ec)) refuse(path, "no such file; check the path");
  if (fs::is_directory(path, ec)) refuse(path, "is a folder, a file is needed");
  if (fs::is_fifo(path, ec)) return read_pipe(path);
  if (fs::is_character_file(path, ec) || fs::is_block_file(path, ec) || fs::is_socket(path, ec))
    refuse(path, "is a device or socket, a file is needed");
  std::ifstream in(path, std::ios::binary);
  if (!in) refuse(path, "cannot be read: " + reason() + "; check its permissions");
  std::ostringstream text;
  text << in.rdbuf();
  if (in.bad()) refuse(path, "reading failed: " + reason());
  return std::move(text).str();
}

void create_folder(const fs::path& folder) {
  std::error_code ec;
  fs::create_directories(folder, ec);
  if (ec || !fs::is_directory(folder))
    throw InputError(folder.string() + ": cannot create this folder: " + (ec ? ec.message() : "a file stands there") +
                     "; choose another place or fix its permissions");
}

void replace_file_atomically(const fs::path& path, const std::function<void(const fs::path&)>& write) {
  create_folder(folder_of(path));
  const fs::path temporary = folder_of(path) / ("." + path.stem().string() + ".partial-" + std::to_string(::getpid()) +
                                                path.extension().string());
  try {
    write(temporary);
    flush_to_disk(temporary);
    fs::rename(temporary, path);
    flush_to_disk(folder_of(path));
  } catch (const fs::filesystem_error& e) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw DeviceError(path.string() + ": cannot put the finished file in place: " + e.code().message());
  } catch (const DeviceError& e) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    std::string message = e.what();  // of a library, which knows the other name
    if (message.rfind(temporary.string(), 0) == 0) message.replace(0, temporary.string().size(), path.string());
    throw DeviceError(message);
  } catch (...) {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw;
  }
}

void write_file_atomically(const fs::path& path, std::string_view content) {
  replace_file_atomically(path, [&](const fs::path& temporary) {
    std::FILE* out = std::fopen(temporary.c_str(), "wb");
    if (!out) throw DeviceError(path.string() + ": cannot write: " + reason());
    const bool written = std::fwrite(content.data(), 1, content.size(), out) == content.size();
    const bool closed = std::fclose(out) == 0;
    if (!written || !closed) throw DeviceError(path.string() + ": cannot write: " + reason());
  });
}

namespace {

struct flock whole_file(short type) {
  struct flock lock {};
  lock.l_type = type;
  lock.l_whence = SEEK_SET;
  return lock;
}

}  // namespace

namespace {

std::atomic<bool> network = false;

}  // namespace

void allow_network() { network = true; }
bool network_allowed() { return network; }

FileLock::~FileLock() {
  if (fd_ >= 0) ::close(fd_);
}

FileLock::FileLock(FileLock&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}

std::optional<FileLock> FileLock::take(const fs::path& path, Kind kind) {
  FileLock result;
  result.fd_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (result.fd_ < 0)
    throw InputError(path.parent_path().string() + ": cannot write here (" + reason() +
                     "); fix its permissions or choose another folder");
  struct flock lock = whole_file(kind == Kind::exclusive ? F_WRLCK : F_RDLCK);
  if (::fcntl(result.fd_, F_OFD_SETLK, &lock) == 0) return result;
  if (errno == EAGAIN || errno == EACCES) return std::nullopt;
  throw DeviceError(path.string() + ": this filesystem has no locks (" + reason() +
                    "), and two runs could mix; choose a folder on another one");
}

std::optional<FileLock::Kind> FileLock::held(const fs::path& path) {
  const int fd = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return std::nullopt;
  struct flock lock = whole_file(F_WRLCK);
  const bool known = ::fcntl(fd, F_OFD_GETLK, &lock) == 0;
  ::close(fd);
  if (!known || lock.l_type == F_UNLCK) return std::nullopt;
  return lock.l_type == F_RDLCK ? Kind::shared : Kind::exclusive;
}

std::optional<FileLock> lock_folder_if_free(const fs::path& folder) {
  create_folder(folder);
  return FileLock::take(folder / ".lock", FileLock::Kind::exclusive);
}

namespace {

/// Whether one of the process's open files holds a lock and is this one.
bool holds(const fs::path& process, const fs::path& lock) {
  std::error_code denied;
  for (const auto& entry : fs::directory_iterator(process / "fd", denied)) {
    std::error_code closed;
    if (fs::read_symlink(entry.path(), closed) != lock || closed) continue;
    std::ifstream about(process / "fdinfo" / entry.path().filename());
    for (std::string line; std::getline(about, line);)
      if (line.rfind("lock:", 0) == 0) return true;
  }
  return false;
}

/// " (process 1234, gonogo-map)" of this machine, as far as /proc shows it; empty for processes of other machines or
/// users.
std::string holder_of(const fs::path& lock) {
  std::error_code failed;
  const fs::path whole = fs::canonical(lock, failed);
  if (failed) return "";
  for (const auto& entry : fs::directory_iterator("/proc", failed)) {
    const std::string number = entry.path().filename().string();
    if (number.find_first_not_of("0123456789") != std::string::npos || !holds(entry.path(), whole)) continue;
    std::ifstream file(entry.path() / "comm");
    std::string name;
    std::getline(file, name);
    return " (process " + number + ", " + name + ")";
  }
  return "";
}

}  // namespace

FileLock lock_folder(const fs::path& folder) {
  if (std::optional<FileLock> lock = lock_folder_if_free(folder)) return std::move(*lock);
  throw InputError(folder.string() + ": another run is using this folder" + holder_of(folder / ".lock") +
                   "; wait for it or choose another folder");
}

}  // namespace gonogo

#define XXH_INLINE_ALL  // header-only: no library to link
#include <xxhash.h>

#include <cstdio>
#include <fstream>
#include <new>
#include <vector>

#include "base/error.h"

namespace gonogo {
namespace {

constexpr std::size_t kBlockBytes = 1 << 20;

std::string hexadecimal(XXH128_hash_t hash) {
  char text[33];
  std::snprintf(text, sizeof text, "%016llx%016llx", static_cast<unsigned long long>(hash.high64),
                static_cast<unsigned long long>(hash.low64));
  return text;
}

}  // namespace

std::string content_hash(std::string_view content) { return hexadecimal(XXH3_128bits(content.data(), content.size())); }

std::string file_hash(const std::filesystem::path& path) {
  std::error_code ec;
  if (!std::filesystem::exists(path, ec)) throw InputError(path.string() + ": no such file; check the path");
  if (std::filesystem::is_directory(path, ec)) throw InputError(path.string() + ": is a folder, a file is needed");
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(path.string() + ": cannot be read; check its permissions");
  const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(), XXH3_freeState);
  if (!state) throw std::bad_alloc();
  XXH3_128bits_reset(state.get());
  std::vector<char> block(kBlockBytes);
  while (in) {
    in.read(block.data(), std::streamsize(block.size()));
    XXH3_128bits_update(state.get(), block.data(), std::size_t(in.gcount()));
  }
  if (in.bad()) throw InputError(path.string() + ": reading failed");
  return hexadecimal(XXH3_128bits_digest(state.get()));
}

}  // namespace gonogo
