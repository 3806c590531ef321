#include "pipeline/campaign/engine/folder.h"

#include <algorithm>

#include "base/error.h"
#include "base/file.h"
#include "base/json/json.h"

namespace gonogo::campaign {
namespace fs = std::filesystem;
namespace {

constexpr const char* kFormat = "gonogo/campaign/1";
constexpr std::size_t kMaxNamed = 4;   // differences spelt out in one sentence
constexpr std::size_t kMaxShown = 60;  // characters of a value

fs::path claim_path(const fs::path& folder) { return folder / "campaign.json"; }
fs::path lock_path(const fs::path& folder) { return folder / "campaign.lock"; }

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
  if (!format || format->string() != kFormat || !claim.find("trials") || !claim.find("trials_per_shard") ||
      !claim.find("depends_on"))
    throw InputError(claim_path(folder).string() + ": is no campaign of the format " + kFormat +
                     "; choose another folder");
  return claim;
}

Claim claim_in(const Json& file) {
  return {std::size_t(file.at("trials").unsigned_integer()),
          std::size_t(file.at("trials_per_shard").unsigned_integer())};
}

void write_claim(const fs::path& folder, const Claim& claim, const Dependencies& depends_on) {
  Json file = Json::object();
  file["format"] = kFormat;
  file["trials"] = std::uint64_t(claim.trials);
  file["trials_per_shard"] = std::uint64_t(claim.trials_per_shard);
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

CampaignLock::CampaignLock(const fs::path& folder, FolderUse use) {
  create_folder(folder);
  const auto kind = use == FolderUse::coordinator ? FileLock::Kind::exclusive : FileLock::Kind::shared;
  std::optional<FileLock> lock = FileLock::take(lock_path(folder), kind);
  if (!lock) {
    const bool tasks = folder_use(folder) == FolderUse::tasks;
    throw InputError(folder.string() + ": " +
                     (tasks ? "tasks of this campaign are at work (gonogo campaign status shows how far they are)"
                            : "another campaign is at work in this folder") +
                     "; wait for the end or choose another folder");
  }
  lock_.emplace(std::move(*lock));
}

FolderUse folder_use(const fs::path& folder) {
  const auto held = FileLock::held(lock_path(folder));
  if (!held) return FolderUse::none;
  return *held == FileLock::Kind::shared ? FolderUse::tasks : FolderUse::coordinator;
}

Claim claim_folder(const fs::path& folder, const Claim& wanted, const Dependencies& depends_on) {
  std::error_code ec;
  Claim claim = wanted;
  const bool exists = fs::exists(claim_path(folder), ec);
  if (exists) {
    const Json file = read_claim_file(folder);
    require_same(folder, file.at("depends_on"), depends_on);
    claim.trials_per_shard = claim_in(file).trials_per_shard;
    if (claim_in(file).trials == wanted.trials) return claim;
  }
  if (!exists && (!journals_of(folder).empty() || fs::exists(folder / "shards", ec)))
    throw InputError(folder.string() + ": holds trials but no campaign.json that says what they depend on; choose " +
                     "another folder");
  write_claim(folder, claim, depends_on);
  return claim;
}

Claim require_claim(const fs::path& folder, std::size_t trials, const Dependencies& depends_on) {
  const Claim claim = read_claim(folder);
  require_same(folder, read_claim_file(folder).at("depends_on"), depends_on);
  if (claim.trials != trials)
    throw InputError(folder.string() + ": this campaign has " + std::to_string(claim.trials) +
                     " trials, the study's design has " + std::to_string(trials) +
                     "; the study changed since it was submitted: submit it again");
  return claim;
}

Claim read_claim(const fs::path& folder) {
  std::error_code ec;
  if (!fs::exists(claim_path(folder), ec))
    throw InputError(folder.string() + ": holds no campaign; give the folder of gonogo campaign run --out");
  return claim_in(read_claim_file(folder));
}

void remove_partial_files(const fs::path& folder) {
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
}

}  // namespace gonogo::campaign
