#include "pipeline/campaign/engine/folder.h"

#include <algorithm>
#include <fstream>
#include <utility>

#include "base/error.h"
#include "base/files/file.h"
#include "base/json/json.h"
#include "base/json/seal.h"

namespace gonogo::campaign {
namespace fs = std::filesystem;
namespace {

constexpr std::chrono::seconds kPaceInterval(2);
constexpr const char* kClaimSeal = "seal";
constexpr const char* kCampaignFormat = "gonogo/campaign/1";
constexpr std::size_t kMaxNamed = 4;   // differences spelt out in one sentence
constexpr std::size_t kMaxShown = 60;  // characters of a value

fs::path claim_path(const fs::path& folder) { return folder / "campaign.json"; }
fs::path lock_path(const fs::path& folder) { return folder / "campaign.lock"; }
fs::path pace_folder(const fs::path& folder) { return folder / "progress"; }

std::string shown(const std::string& value) {
  return value.size() <= kMaxShown ? value : value.substr(0, kMaxShown) + "...";
}

/// What campaign.json says.
struct Claim {
  ShardPlan plan;
  Dependencies depends_on;
};

/// Empty where the folder holds no campaign.
std::optional<Claim> find_claim(const fs::path& folder) {
  std::error_code ec;
  if (!fs::exists(claim_path(folder), ec)) return std::nullopt;
  const Json file = Json::read(claim_path(folder));
  const Json* format = file.find("format");
  if (!format || !format->is_string() || format->string() != kCampaignFormat || !file.find("trials") ||
      !file.find("trials_per_shard") || !file.find("depends_on"))
    throw InputError(claim_path(folder).string() + ": is no campaign of the format " + kCampaignFormat +
                     "; choose another folder");
  // Campaigns that ship are older than seals, and their files hold nothing else.
  if (file.members().size() > 4)
    require_seal(file, claim_path(folder).string(), "restore it, or choose another folder", kClaimSeal);
  Claim claim{{file.at("trials").unsigned_integer(), file.at("trials_per_shard").unsigned_integer()}, {}};
  for (const auto& [name, value] : file.at("depends_on").members())
    claim.depends_on.emplace_back(name, value.is_string() ? value.string() : value.dump());
  return claim;
}

Claim read_whole_claim(const fs::path& folder) {
  if (std::optional<Claim> claim = find_claim(folder)) return std::move(*claim);
  throw InputError(folder.string() + ": holds no campaign; give the folder of gonogo campaign run --out");
}

void write_claim(const fs::path& folder, const Claim& claim) {
  Json file = Json::object();
  file["format"] = kCampaignFormat;
  file["trials"] = claim.plan.trials;
  file["trials_per_shard"] = claim.plan.per_shard;
  Json& entries = file["depends_on"];
  entries = Json::object();
  for (const auto& [name, value] : claim.depends_on) entries[name] = value;
  write_file_atomically(claim_path(folder), sealed(std::move(file), kClaimSeal).dump(2) + "\n");
}

/// Throws InputError with a phrase for each dependency that was added, changed or removed.
void require_same(const fs::path& folder, const Dependencies& before, const Dependencies& now) {
  const auto find = [](const Dependencies& all, const std::string& name) {
    return std::find_if(all.begin(), all.end(), [&](const auto& entry) { return entry.first == name; });
  };
  std::vector<std::string> phrases;
  for (const auto& [name, value] : now) {
    const auto old = find(before, name);
    if (old == before.end())
      phrases.emplace_back(name + " is new (" + shown(value) + ")");
    else if (old->second != value)
      phrases.emplace_back(name + " was " + shown(old->second) + ", is " + shown(value));
  }
  for (const auto& [name, value] : before)
    if (find(now, name) == now.end()) phrases.emplace_back(name + " is gone (was " + shown(value) + ")");
  if (phrases.empty()) return;
  std::string text;
  for (std::size_t i = 0; i < std::min(phrases.size(), kMaxNamed); ++i) text += (i > 0 ? "; " : "") + phrases[i];
  if (phrases.size() > kMaxNamed) text += "; and " + std::to_string(phrases.size() - kMaxNamed) + " more";
  throw InputError(folder.string() + ": the trials here were computed with other inputs: " + text +
                   "; undo the change or choose another folder");
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
      journals.emplace_back(entry.path());
  std::sort(journals.begin(), journals.end());
  return journals;
}
fs::path origin_path(const fs::path& folder) { return folder / "origin.h5"; }
fs::path dataset_path(const fs::path& folder) { return folder / "dataset.h5"; }
fs::path running_folder(const fs::path& folder) { return folder / "running"; }
fs::path course_folder(const fs::path& folder) { return folder / "courses"; }
fs::path saved_trial_path(const fs::path& running, std::uint64_t index) {
  return running / ("trial-" + std::to_string(index) + ".h5");
}

FolderUse folder_use(const fs::path& folder) {
  const auto held = FileLock::held(lock_path(folder));
  if (!held) return FolderUse::none;
  return *held == FileLock::Kind::shared ? FolderUse::tasks : FolderUse::coordinator;
}

ShardPlan read_claim(const fs::path& folder) { return read_whole_claim(folder).plan; }

namespace {

FileLock lock_campaign(const fs::path& folder, FolderUse use) {
  create_folder(folder);
  const auto kind = use == FolderUse::coordinator ? FileLock::Kind::exclusive : FileLock::Kind::shared;
  if (std::optional<FileLock> lock = FileLock::take(lock_path(folder), kind)) return std::move(*lock);
  const bool tasks = FileLock::held(lock_path(folder)) == FileLock::Kind::shared;
  throw InputError(folder.string() + ": " +
                   (tasks ? "tasks of this campaign are at work (gonogo campaign status shows how far they are)"
                          : "another campaign is at work in this folder") +
                   "; wait for the end or choose another folder");
}

/// Removes files beside their targets, and speeds. Needs the coordinator's lock.
void remove_leftovers(const fs::path& folder) {
  for (const fs::path& place : {folder, folder / "trials", folder / "shards", running_folder(folder)}) {
    std::error_code ec;
    for (const auto& entry : fs::directory_iterator(place, ec)) {
      const std::string name = entry.path().filename().string();
      bool ours = false;
      for (const char* start : {".dataset.", ".campaign.", ".origin.", ".local.", ".trial-", ".shard-"})
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
  FileLock lock = lock_campaign(folder, FolderUse::coordinator);
  const std::optional<Claim> before = find_claim(folder);
  std::error_code ec;
  if (before)
    require_same(folder, before->depends_on, depends_on);
  else if (!journals_of(folder).empty() || fs::exists(folder / "shards", ec))
    throw InputError(folder.string() + ": holds trials but no campaign.json that says what they depend on; choose " +
                     "another folder");
  const ShardPlan plan{wanted.trials, before ? before->plan.per_shard : std::max<std::uint64_t>(1, wanted.per_shard)};
  if (!before || before->plan.trials != plan.trials) write_claim(folder, {plan, depends_on});
  remove_leftovers(folder);
  return {std::move(lock), plan};
}

HeldFolder hold_claimed_folder(const fs::path& folder, FolderUse use, std::uint64_t trials,
                               const Dependencies& depends_on) {
  FileLock lock = lock_campaign(folder, use);
  const Claim claim = read_whole_claim(folder);
  require_same(folder, claim.depends_on, depends_on);
  if (claim.plan.trials != trials)
    throw InputError(folder.string() + ": this campaign has " + std::to_string(claim.plan.trials) +
                     " trials, the study's design has " + std::to_string(trials) +
                     "; the study changed since it was submitted: submit it again");
  if (use == FolderUse::coordinator) remove_leftovers(folder);
  return {std::move(lock), claim.plan};
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
