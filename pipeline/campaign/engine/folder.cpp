#include "pipeline/campaign/engine/folder.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <utility>

#include "base/error.h"
#include "base/files/file.h"
#include "base/json/json.h"

namespace gonogo::campaign {
namespace fs = std::filesystem;
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

namespace {

constexpr std::chrono::seconds kPaceInterval(2);
constexpr const char* kCampaignFormat = "gonogo/campaign/1";
constexpr std::size_t kMaxNamed = 4;   // differences spelt out in one sentence
constexpr std::size_t kMaxShown = 60;  // characters of a value

fs::path claim_path(const fs::path& folder) { return folder / "campaign.json"; }
fs::path lock_path(const fs::path& folder) { return folder / "campaign.lock"; }
fs::path pace_folder(const fs::path& folder) { return folder / "progress"; }

std::string shown(const std::string& value) {
  return value.size() <= kMaxShown ? value : value.substr(0, kMaxShown) + "...";
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
  for (std::size_t i = 0; i < std::min(phrases.size(), kMaxNamed); ++i) text += (i > 0 ? "; " : "") + phrases[i];
  if (phrases.size() > kMaxNamed) text += "; and " + std::to_string(phrases.size() - kMaxNamed) + " more";
  throw InputError(folder.string() + ": the trials here were computed with other inputs: " + text +
                   "; undo the change or choose another folder");
}

Json read_claim_file(const fs::path& folder) {
  Json claim = Json::read(claim_path(folder));
  const Json* format = find_text(claim, "format");
  if (!format || format->string() != kCampaignFormat || !claim.find("trials") || !claim.find("trials_per_shard") ||
      !claim.find("depends_on"))
    throw InputError(claim_path(folder).string() + ": is no campaign of the format " + kCampaignFormat +
                     "; choose another folder");
  return claim;
}

ShardPlan plan_in(const Json& file) {
  return {file.at("trials").unsigned_integer(), file.at("trials_per_shard").unsigned_integer()};
}

void write_claim(const fs::path& folder, const ShardPlan& plan, const Dependencies& depends_on) {
  Json file = Json::object();
  file["format"] = kCampaignFormat;
  file["trials"] = plan.trials;
  file["trials_per_shard"] = plan.per_shard;
  Json& entries = file["depends_on"];
  entries = Json::object();
  for (const auto& [name, value] : depends_on) entries[name] = value;
  write_file_atomically(claim_path(folder), file.dump(2) + "\n");
}

}  // namespace

fs::path journal_path(const fs::path& folder) { return folder / "trials" / "local.csv"; }
fs::path journal_path(const fs::path& folder, std::uint64_t shard) {
  return folder / "trials" / ("shard-" + std::to_string(shard) + ".csv");
}
std::vector<fs::path> journals_of(const fs::path& folder) {
  std::vector<fs::path> journals;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder / "trials", none))
    if (entry.path().extension() == ".csv" && entry.path().filename().string()[0] != '.')
      journals.push_back(entry.path());
  std::sort(journals.begin(), journals.end());
  return journals;
}
fs::path dataset_path(const fs::path& folder) { return folder / "dataset.h5"; }
fs::path running_folder(const fs::path& folder) { return folder / "running"; }
fs::path saved_trial_path(const fs::path& running, std::uint64_t index) {
  return running / ("trial-" + std::to_string(index) + ".h5");
}

FolderUse folder_use(const fs::path& folder) {
  const auto held = FileLock::held(lock_path(folder));
  if (!held) return FolderUse::none;
  return *held == FileLock::Kind::shared ? FolderUse::tasks : FolderUse::coordinator;
}

ShardPlan read_claim(const fs::path& folder) {
  std::error_code ec;
  if (!fs::exists(claim_path(folder), ec))
    throw InputError(folder.string() + ": holds no campaign; give the folder of gonogo campaign run --out");
  return plan_in(read_claim_file(folder));
}

namespace {

FileLock lock_folder(const fs::path& folder, FolderUse use) {
  create_folder(folder);
  const auto kind = use == FolderUse::coordinator ? FileLock::Kind::exclusive : FileLock::Kind::shared;
  if (std::optional<FileLock> lock = FileLock::take(lock_path(folder), kind)) return std::move(*lock);
  const bool tasks = folder_use(folder) == FolderUse::tasks;
  throw InputError(folder.string() + ": " +
                   (tasks ? "tasks of this campaign are at work (gonogo campaign status shows how far they are)"
                          : "another campaign is at work in this folder") +
                   "; wait for the end or choose another folder");
}

ShardPlan claim_folder(const fs::path& folder, const ShardPlan& wanted, const Dependencies& depends_on) {
  std::error_code ec;
  ShardPlan plan{wanted.trials, std::max<std::uint64_t>(1, wanted.per_shard)};
  const bool exists = fs::exists(claim_path(folder), ec);
  if (exists) {
    const Json file = read_claim_file(folder);
    require_same(folder, file.at("depends_on"), depends_on);
    plan.per_shard = plan_in(file).per_shard;
    if (plan_in(file).trials == wanted.trials) return plan;
  }
  if (!exists && (!journals_of(folder).empty() || fs::exists(folder / "shards", ec)))
    throw InputError(folder.string() + ": holds trials but no campaign.json that says what they depend on; choose " +
                     "another folder");
  write_claim(folder, plan, depends_on);
  return plan;
}

/// Removes files beside their targets, and speeds. Needs the coordinator's lock.
void remove_leftovers(const fs::path& folder) {
  for (const fs::path& place : {folder, folder / "trials", folder / "shards", running_folder(folder)}) {
    std::error_code ec;
    for (const auto& entry : fs::directory_iterator(place, ec)) {
      const std::string name = entry.path().filename().string();
      bool ours = false;
      for (const char* start : {".dataset.", ".campaign.", ".local.", ".trial-", ".shard-"})
        ours = ours || name.rfind(start, 0) == 0;
      std::error_code ignored;
      if (ours && name.find(".partial-") != std::string::npos) fs::remove(entry.path(), ignored);
    }
  }
  std::error_code ignored;
  fs::remove_all(pace_folder(folder), ignored);
}

}  // namespace

HeldFolder hold_folder(const fs::path& folder, const ShardPlan& wanted, const Dependencies& depends_on) {
  FileLock lock = lock_folder(folder, FolderUse::coordinator);
  const ShardPlan plan = claim_folder(folder, wanted, depends_on);
  remove_leftovers(folder);
  return {std::move(lock), plan};
}

HeldFolder hold_claimed_folder(const fs::path& folder, FolderUse use, std::uint64_t trials,
                               const Dependencies& depends_on) {
  FileLock lock = lock_folder(folder, use);
  const ShardPlan plan = read_claim(folder);
  require_same(folder, read_claim_file(folder).at("depends_on"), depends_on);
  if (plan.trials != trials)
    throw InputError(folder.string() + ": this campaign has " + std::to_string(plan.trials) +
                     " trials, the study's design has " + std::to_string(trials) +
                     "; the study changed since it was submitted: submit it again");
  if (use == FolderUse::coordinator) remove_leftovers(folder);
  return {std::move(lock), plan};
}

PaceWriter::PaceWriter(const fs::path& folder, const std::string& writer)
    : path_(pace_folder(folder) / (writer + ".json")), start_(std::chrono::steady_clock::now()), last_(start_) {}

PaceWriter::~PaceWriter() {
  std::error_code ignored;
  fs::remove(path_, ignored);
  fs::remove(path_.parent_path(), ignored);  // when it is empty
}

void PaceWriter::tell_if_due() {
  const auto now = std::chrono::steady_clock::now();
  if (now - last_ < kPaceInterval) return;
  last_ = now;
  std::error_code ignored;
  fs::create_directories(path_.parent_path(), ignored);
  const fs::path beside = path_.string() + ".new";
  Json json = Json::object();
  json["trials"] = std::uint64_t(done_);
  json["seconds"] = std::chrono::duration<double>(now - start_).count();
  std::ofstream(beside) << json.dump() << "\n";  // may be lost: it is worth nothing after a crash
  fs::rename(beside, path_, ignored);
}

double total_pace(const fs::path& folder) {
  double pace = 0;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(pace_folder(folder), none)) {
    if (entry.path().extension() != ".json") continue;
    try {
      const Json json = Json::read(entry.path());
      if (json.at("seconds").number() > 0) pace += json.at("trials").number() / json.at("seconds").number();
    } catch (const InputError&) {  // it ended while we looked
    }
  }
  return pace;
}

}  // namespace gonogo::campaign
