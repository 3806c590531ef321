#include "base/files/record_log.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "base/error.h"
#include "base/files/file.h"

namespace gonogo {
namespace {

constexpr std::size_t kHash = 32;

struct Head {
  std::uint32_t number, size;
  char hash[kHash];  // of number and content
};

std::string hash_of(std::uint32_t number, std::string_view content) {
  return content_hash(content_hash(content) + std::to_string(number));
}

std::string first_line(const std::string& key) { return "gonogo records 1 " + content_hash(key) + "\n"; }

}  // namespace

RecordLog::RecordLog(std::filesystem::path path, const std::string& key) : path_(std::move(path)) {
  if (path_.has_parent_path()) create_folder(path_.parent_path());
  file_ = ::open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (file_ < 0) throw DeviceError(path_.string() + ": cannot be written: " + std::strerror(errno));
  const std::string line = first_line(key);
  std::string found(line.size(), '\0');
  if (read_at(0, found.data(), found.size()) && found == line) {
    end_ = line.size();
    find_records();
  } else {
    end_ = line.size();
    if (::ftruncate(file_, 0) != 0 || ::pwrite(file_, line.data(), line.size(), 0) != ssize_t(line.size()))
      throw DeviceError(path_.string() + ": cannot be written: " + std::strerror(errno));
  }
}

RecordLog::~RecordLog() {
  if (file_ >= 0) ::close(file_);
}

bool RecordLog::read_at(std::uint64_t offset, void* to, std::size_t size) const {
  auto* out = static_cast<char*>(to);
  while (size > 0) {
    const ssize_t got = ::pread(file_, out, size, off_t(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    out += got;
    offset += std::uint64_t(got);
    size -= std::size_t(got);
  }
  return true;
}

void RecordLog::find_records() {
  Head head;
  std::string content;
  while (read_at(end_, &head, sizeof head)) {
    if (head.size > (1u << 30)) break;
    content.resize(head.size);
    if (!read_at(end_ + sizeof head, content.data(), content.size())) break;
    if (hash_of(head.number, content) != std::string_view(head.hash, kHash)) break;
    place_[head.number] = {end_ + sizeof head, head.size};
    end_ += sizeof head + head.size;
  }
  if (::ftruncate(file_, off_t(end_)) != 0)
    throw DeviceError(path_.string() + ": cannot be shortened: " + std::strerror(errno));
}

void RecordLog::append(std::uint32_t number, std::string_view content) {
  Head head{number, std::uint32_t(content.size()), {}};
  std::memcpy(head.hash, hash_of(number, content).data(), kHash);
  std::string bytes(reinterpret_cast<const char*>(&head), sizeof head);
  bytes += content;
  const std::lock_guard lock(mutex_);
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t put = ::pwrite(file_, bytes.data() + done, bytes.size() - done, off_t(end_ + done));
    if (put < 0 && errno == EINTR) continue;
    if (put <= 0) throw DeviceError(path_.string() + ": cannot be written: " + std::strerror(errno));
    done += std::size_t(put);
  }
  place_[number] = {end_ + sizeof head, head.size};
  end_ += bytes.size();
}

bool RecordLog::has(std::uint32_t number) const {
  const std::lock_guard lock(mutex_);
  return place_.count(number) > 0;
}

std::size_t RecordLog::size_of(std::uint32_t number) const {
  const std::lock_guard lock(mutex_);
  const auto found = place_.find(number);
  return found == place_.end() ? 0 : found->second.size;
}

std::string RecordLog::read(std::uint32_t number) const {
  Place place;
  {
    const std::lock_guard lock(mutex_);
    const auto found = place_.find(number);
    if (found == place_.end()) throw DeviceError(path_.string() + ": record " + std::to_string(number) + " is missing");
    place = found->second;
  }
  std::string content(place.size, '\0');
  if (!read_at(place.offset, content.data(), content.size()))
    throw DeviceError(path_.string() + ": cannot be read: " + std::strerror(errno));
  return content;
}

void RecordLog::remove() {
  if (file_ >= 0) ::close(file_);
  file_ = -1;
  std::error_code ignored;
  std::filesystem::remove(path_, ignored);
}

}  // namespace gonogo
