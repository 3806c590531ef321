#include "pipeline/campaign/folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "base/error.h"
#include "base/file.h"
#include "base/json/json.h"

namespace gonogo::pipeline {
namespace fs = std::filesystem;
namespace {

constexpr const char* kFormat = "gonogo/campaign/1";
constexpr std::size_t kMostNamed = 4;   // differences spelt out in one sentence
constexpr std::size_t kMostShown = 60;  // characters of a value

fs::path claim_path(const fs::path& folder) { return folder / "campaign.json"; }
fs::path lock_path(const fs::path& folder) { return folder / "campaign.lock"; }

std::string shown(const std::string& value) {
  return value.size() <= kMostShown ? value : value.substr(0, kMostShown) + "...";
}

const Json* find_text(const Json& object, const std::string& name) {
  const Json* value = object.find(name);
  return value && value->is_string() ? value : nullptr;
}

/// One phrase per dependency that was added, removed or changed.
std::vector<std::string> differences(const Json& before, const Dependencies& now) {
  std::vector<std::string> phrases;
  for (const auto& [name, value] : now) {
    const Json* old = find_text(before, name);
    if (!old) phrases.push_back(name + " is new (" + shown(value) + ")");
    if (old && old->string() != value)
      phrases.push_back(name + " was " + shown(old->string()) + ", is " + shown(value));
  }
  for (const auto& [name, value] : before.members())
    if (std::none_of(now.begin(), now.end(), [&name = name](const auto& entry) { return entry.first == name; }))
      phrases.push_back(name + " is gone (was " + shown(value.is_string() ? value.string() : value.dump()) + ")");
  return phrases;
}

void require_same(const fs::path& folder, const Json& before, const Dependencies& now) {
  const std::vector<std::string> phrases = differences(before, now);
  if (phrases.empty()) return;
  std::string text;
  for (std::size_t i = 0; i < std::min(phrases.size(), kMostNamed); ++i) text += (i > 0 ? "; " : "") + phrases[i];
  if (phrases.size() > kMostNamed) text += "; and " + std::to_string(phrases.size() - kMostNamed) + " more";
  throw InputError(folder.string() + ": the trials here were computed with other inputs: " + text +
                   "; undo the change or choose another folder");
}

Json read_claim(const fs::path& folder) {
  const Json claim = Json::read(claim_path(folder));
  const Json* format = find_text(claim, "format");
  if (!format || format->string() != kFormat || !claim.find("trials") || !claim.find("depends_on"))
    throw InputError(claim_path(folder).string() + ": is no campaign of the format " + kFormat +
                     "; choose another folder");
  return claim;
}

}  // namespace

fs::path journal_path(const fs::path& folder) { return folder / "trials" / "local.csv"; }
fs::path dataset_path(const fs::path& folder) { return folder / "dataset.h5"; }
fs::path running_folder(const fs::path& folder) { return folder / "running"; }
fs::path saved_trial_path(const fs::path& running, std::uint64_t index) {
  return running / ("trial-" + std::to_string(index) + ".h5");
}

FolderLock::FolderLock(const fs::path& folder) {
  create_folder(folder);
  const fs::path path = lock_path(folder);
  fd_ = ::open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  if (fd_ < 0)
    throw InputError(folder.string() + ": cannot write here (" + std::strerror(errno) +
                     "); fix its permissions or choose another folder");
  if (::flock(fd_, LOCK_EX | LOCK_NB) == 0) return;
  const int error = errno;
  ::close(fd_);
  if (error == EWOULDBLOCK)
    throw InputError(folder.string() + ": another campaign is at work in this folder; wait for it to end or choose " +
                     "another folder");
  throw DeviceError(path.string() + ": this filesystem has no locks (" + std::strerror(error) +
                    "), so that two campaigns could mix; choose a folder on another one");
}

FolderLock::~FolderLock() { ::close(fd_); }

bool is_locked(const fs::path& folder) {
  const int fd = ::open(lock_path(folder).c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return false;
  const bool locked = ::flock(fd, LOCK_SH | LOCK_NB) != 0 && errno == EWOULDBLOCK;
  ::close(fd);
  return locked;
}

void claim_folder(const fs::path& folder, std::size_t trials, const Dependencies& depends_on) {
  std::error_code ec;
  const bool exists = fs::exists(claim_path(folder), ec);
  if (exists) {
    const Json claim = read_claim(folder);
    require_same(folder, claim.at("depends_on"), depends_on);
    if (claim.at("trials").unsigned_integer() == trials) return;
  }
  if (!exists && fs::exists(journal_path(folder), ec))
    throw InputError(folder.string() + ": holds trials but no campaign.json that says what they depend on; choose " +
                     "another folder");
  Json claim = Json::object();
  claim["format"] = kFormat;
  claim["trials"] = std::uint64_t(trials);
  Json& entries = claim["depends_on"];
  entries = Json::object();
  for (const auto& [name, value] : depends_on) entries[name] = value;
  write_file_atomically(claim_path(folder), claim.dump(2) + "\n");
}

std::size_t claimed_trials(const fs::path& folder) {
  std::error_code ec;
  if (!fs::exists(claim_path(folder), ec))
    throw InputError(folder.string() + ": holds no campaign; give the folder of gonogo campaign run --out");
  return std::size_t(read_claim(folder).at("trials").unsigned_integer());
}

void remove_partial_files(const fs::path& folder) {
  for (const fs::path& place : {folder, folder / "trials", running_folder(folder)}) {
    std::error_code ec;
    for (const auto& entry : fs::directory_iterator(place, ec)) {
      const std::string name = entry.path().filename().string();
      bool ours = false;
      for (const char* start : {".dataset.", ".campaign.", ".local.", ".trial-"})
        ours = ours || name.rfind(start, 0) == 0;
      std::error_code ignored;
      if (ours && name.find(".partial-") != std::string::npos) fs::remove(entry.path(), ignored);
    }
  }
}

}  // namespace gonogo::pipeline
