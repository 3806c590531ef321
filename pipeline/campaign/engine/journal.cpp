#include "pipeline/campaign/engine/journal.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "base/error.h"
#include "base/file.h"
#include "base/hash.h"
#include "pipeline/campaign/dataset/row.h"

namespace gonogo::campaign {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kHashDigits = 32;
constexpr std::chrono::milliseconds kFlushInterval(1000);

[[noreturn]] void fail(const fs::path& path, const std::string& what, int error) {
  throw DeviceError(path.string() + ": cannot " + what + ": " + std::strerror(error) +
                    "; all trials before are kept, so make room or fix permissions and run the same command again");
}

void keep(JournalContent& content, const fs::path& path, TrialRecord record, std::string_view row) {
  const std::uint64_t index = record.point.index;
  const auto [place, is_new] = content.records.emplace(index, std::move(record));
  if (is_new) content.intact += seal_line(row);
  if (!is_new && to_row(place->second) != row)
    throw InputError(path.string() + ": trial " + std::to_string(index) +
                     " has two different results, so that its rows come from different programs; use another folder");
}

}  // namespace

std::string seal_line(std::string_view text) { return content_hash(text) + " " + std::string(text) + "\n"; }

std::optional<std::string_view> unseal_line(std::string_view line) {
  if (line.size() <= kHashDigits || line[kHashDigits] != ' ') return std::nullopt;
  const std::string_view text = line.substr(kHashDigits + 1);
  if (content_hash(text) != line.substr(0, kHashDigits)) return std::nullopt;
  return text;
}

JournalContent read_journal(const fs::path& path) {
  JournalContent content;
  std::error_code ec;
  if (!fs::exists(path, ec)) return content;
  const std::string text = read_file(path);
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = text.find('\n', begin);
    const bool whole = end != std::string::npos;
    const std::string_view line = std::string_view(text).substr(begin, whole ? end - begin : end);
    begin = whole ? end + 1 : text.size();
    const std::optional<std::string_view> row = whole ? unseal_line(line) : std::nullopt;
    std::optional<TrialRecord> record = row ? parse_record(*row) : std::nullopt;
    if (record) {
      keep(content, path, std::move(*record), *row);
    } else {
      content.damaged += std::string(line) + "\n";
      ++content.damaged_count;
    }
  }
  return content;
}

JournalContent recover_journal(const fs::path& path) {
  JournalContent content = read_journal(path);
  if (content.damaged_count == 0) return content;
  const fs::path aside = path.string() + ".damaged";
  std::error_code ec;
  const std::string before = fs::exists(aside, ec) ? read_file(aside) : "";
  write_file_atomically(aside, before + content.damaged);
  write_file_atomically(path, content.intact);
  return content;
}

void write_journal(const fs::path& path, const std::vector<TrialRecord>& records) {
  std::string text;
  for (const TrialRecord& record : records) text += seal_line(to_row(record));
  write_file_atomically(path, text);
}

Journal::Journal(const fs::path& path) : path_(path), last_flush_(std::chrono::steady_clock::now()) {
  fd_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (fd_ < 0) fail(path_, "write here", errno);
}

Journal::~Journal() {
  if (dirty_) ::fsync(fd_);
  ::close(fd_);
}

void Journal::append(const TrialRecord& record) {
  append_line(seal_line(to_row(record)));
  dirty_ = true;
}

void Journal::append_line(const std::string& line) {
  const off_t before = ::lseek(fd_, 0, SEEK_END);
  for (std::size_t done = 0; done < line.size();) {
    const ssize_t count = ::write(fd_, line.data() + done, line.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) {
      const int error = count == 0 ? ENOSPC : errno;
      [[maybe_unused]] const int ignored = ::ftruncate(fd_, before);  // a torn line is found by its hash anyway
      fail(path_, "store a finished trial", error);
    }
    done += std::size_t(count);
  }
}

void Journal::flush_if_due() {
  if (dirty_ && std::chrono::steady_clock::now() - last_flush_ > kFlushInterval) flush();
}

void Journal::flush() {
  if (dirty_ && ::fsync(fd_) != 0) fail(path_, "flush finished trials to the disk", errno);
  dirty_ = false;
  last_flush_ = std::chrono::steady_clock::now();
}

}  // namespace gonogo::campaign
