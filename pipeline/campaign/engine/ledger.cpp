#include "pipeline/campaign/engine/ledger.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <numeric>

#include "base/error.h"
#include "base/files/file.h"
#include "base/json/json.h"
#include "base/json/seal.h"
#include "base/progress.h"
#include "pipeline/campaign/dataset/row.h"

namespace gonogo::campaign {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kHashDigits = 32;
constexpr std::chrono::milliseconds kFlushInterval(1000);

[[noreturn]] void fail_to(const fs::path& path, const std::string& what, int error) {
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

void write_journal(const fs::path& path, const std::vector<TrialRecord>& records) {
  std::string text;
  for (const TrialRecord& record : records) text += seal_line(to_row(record));
  write_file_atomically(path, text);
}

Journal::Journal(const fs::path& path) : path_(path), last_flush_(std::chrono::steady_clock::now()) {
  create_folder(path.parent_path());
  fd_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (fd_ < 0) fail_to(path_, "write here", errno);
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
      fail_to(path_, "store a finished trial", error);
    }
    done += std::size_t(count);
  }
}

void Journal::flush_if_due() {
  if (dirty_ && std::chrono::steady_clock::now() - last_flush_ > kFlushInterval) flush();
}

void Journal::flush() {
  if (dirty_ && ::fsync(fd_) != 0) fail_to(path_, "flush finished trials to the disk", errno);
  dirty_ = false;
  last_flush_ = std::chrono::steady_clock::now();
}

namespace {

constexpr const char* kManifestSeal = "seal";
constexpr const char* kShardFormat = "gonogo/shard/1";

fs::path manifest_path(const fs::path& folder, std::uint64_t shard) {
  return shard_folder(folder) / ("shard-" + std::to_string(shard) + ".json");
}

Counts counts_in(const Json& object) {
  Counts counts;
  for (const auto& [name, number] : object.members()) counts[name] = std::size_t(number.unsigned_integer());
  return counts;
}

/// Removes files of the shard that its manifest does not name.
void remove_others(const fs::path& folder, std::uint64_t shard, const std::string& file) {
  const std::string start = "shard-" + std::to_string(shard) + ".";
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(shard_folder(folder), ignored)) {
    const std::string name = entry.path().filename().string();
    if (name.rfind(start, 0) == 0 && entry.path().extension() == ".h5" && name != file)
      fs::remove(entry.path(), ignored);
  }
}

[[noreturn]] void refuse(const fs::path& path, const std::string& what) {
  throw InputError(path.string() + ": " + what);
}

void check_file(const fs::path& file, const ShardManifest& manifest) {
  std::error_code missing;
  const std::uint64_t bytes = fs::file_size(file, missing);
  if (missing) refuse(file, "is missing or cannot be read, though its manifest names it");
  if (bytes != manifest.bytes)
    refuse(file, "has " + std::to_string(bytes) + " bytes, its manifest says " + std::to_string(manifest.bytes));
  if (file_hash(file) != manifest.hash) refuse(file, "its bytes do not match the hash in its manifest");
}

}  // namespace

fs::path shard_folder(const fs::path& folder) { return folder / "shards"; }

void commit_shard(const fs::path& folder, std::uint64_t shard, const std::vector<TrialRecord>& records,
                  const Provenance& provenance, const std::string& campaign) {
  const std::string image = dataset_image({.records = records, .provenance = provenance});
  const std::string file = "shard-" + std::to_string(shard) + "." + std::to_string(records.size()) + ".h5";
  write_file_atomically(shard_folder(folder) / file, image);
  Counts by_verdict, by_reason;
  for (const TrialRecord& record : records) count_outcome(record, by_verdict, by_reason);
  Json manifest = Json::object();
  manifest["format"] = kShardFormat;
  manifest["campaign"] = campaign;
  manifest["first"] = records.front().point.index;
  manifest["trials"] = std::uint64_t(records.size());
  manifest["file"] = file;
  manifest["bytes"] = std::uint64_t(image.size());
  manifest["hash"] = content_hash(image);
  manifest["verdicts"] = counts_json(by_verdict);
  manifest["reasons"] = counts_json(by_reason);
  write_file_atomically(manifest_path(folder, shard), sealed(std::move(manifest), kManifestSeal).dump(2) + "\n");
  remove_others(folder, shard, file);
}

std::optional<ShardManifest> read_manifest(const fs::path& folder, std::uint64_t shard) {
  const fs::path path = manifest_path(folder, shard);
  std::error_code ec;
  if (!fs::exists(path, ec)) return std::nullopt;
  const Json json = Json::read(path);
  const std::vector<std::string> keys{"format", "campaign", "first",    "trials", "file",
                                      "bytes",  "hash",     "verdicts", "reasons"};
  for (const std::string& key : keys)
    if (!json.find(key)) refuse(path, "lacks \"" + key + "\"");
  // Manifests of campaigns that ship are older than seals, and hold nothing else.
  if (json.members().size() > keys.size())
    require_seal(json, path.string(), "remove it, and its trials are computed again", kManifestSeal);
  if (json.at("format").string() != kShardFormat) refuse(path, std::string("is not of the format ") + kShardFormat);
  return ShardManifest{.range = {json.at("first").unsigned_integer(), json.at("trials").unsigned_integer()},
                       .campaign = json.at("campaign").string(),
                       .file = json.at("file").string(),
                       .hash = json.at("hash").string(),
                       .bytes = json.at("bytes").unsigned_integer(),
                       .by_verdict = counts_in(json.at("verdicts")),
                       .by_reason = counts_in(json.at("reasons"))};
}

std::optional<std::vector<TrialRecord>> read_shard(const fs::path& folder, std::uint64_t shard,
                                                   const std::string& campaign) {
  const std::optional<ShardManifest> manifest = read_manifest(folder, shard);
  if (!manifest) return std::nullopt;
  const fs::path file = shard_folder(folder) / manifest->file;
  if (manifest->campaign != campaign) refuse(file, "its trials depend on other inputs than this campaign's");
  check_file(file, *manifest);
  Dataset dataset = read_dataset(file);
  if (dataset.records.size() != manifest->range.count)
    refuse(file, "holds " + std::to_string(dataset.records.size()) + " trials, its manifest says " +
                     std::to_string(manifest->range.count));
  for (std::size_t i = 0; i < dataset.records.size(); ++i)
    if (dataset.records[i].point.index != manifest->range.first + i)
      refuse(file, "its trials are not those that its manifest names");
  return std::move(dataset.records);
}

namespace {

bool is_same(const DesignPoint& a, const DesignPoint& b) {
  return a.index == b.index && a.seed == b.seed && a.replicate_of == b.replicate_of &&
         a.proposal_density == b.proposal_density && a.variables == b.variables;
}

/// As read_journal, and moves damaged lines to "<journal>.damaged", so that their trials are computed again.
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

/// Renames manifest and file to *.damaged, so that the shard is not committed any more.
void set_shard_aside(const fs::path& folder, std::uint64_t shard) {
  const std::string start = "shard-" + std::to_string(shard) + ".";
  std::error_code ignored;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(shard_folder(folder), ignored)) {
    const std::string extension = entry.path().extension().string();
    if (entry.path().filename().string().rfind(start, 0) == 0 && (extension == ".h5" || extension == ".json"))
      files.push_back(entry.path());
  }
  for (const fs::path& file : files) fs::rename(file, file.string() + ".damaged", ignored);
}

}  // namespace

Ledger::Ledger(const CampaignRequest& request, ShardPlan plan, std::vector<std::uint64_t> shards)
    : request_(request),
      plan_(plan),
      shards_(std::move(shards)),
      looked_at_(plan.count(), false),
      committed_(plan.count(), false),
      done_(request.design.size(), false) {
  std::string text;
  for (const auto& [name, value] : request.depends_on) text.append(name).append("\n").append(value).append("\n");
  campaign_ = content_hash(text);
  for (const std::uint64_t shard : shards_) looked_at_[shard] = true;
}

Ledger recovered_ledger(const CampaignRequest& request, ShardPlan plan) {
  std::vector<std::uint64_t> shards(plan.count());
  std::iota(shards.begin(), shards.end(), std::uint64_t(0));
  Ledger ledger(request, plan, std::move(shards));
  ledger.load();
  ledger.gather_journals();
  return ledger;
}

void Ledger::load(const fs::path& own_journal) {
  for (const std::uint64_t shard : shards_) {
    try {
      load_shard(shard);
    } catch (const InputError& error) {
      set_shard_aside(request_.folder, shard);
      ++damaged_;
      log_line("campaign", std::string(error.what()) + "; shard " + std::to_string(shard) +
                               " is set aside as *.damaged and its trials are computed again");
    }
  }
  for (const fs::path& journal : journals_of(request_.folder))
    load_journal(journal, own_journal.empty() || journal == own_journal);
  for (const std::uint64_t shard : shards_) commit_if_whole(shard);
}

void Ledger::load_shard(std::uint64_t shard) {
  std::optional<std::vector<TrialRecord>> records = read_shard(request_.folder, shard, campaign_);
  if (!records) return;
  for (const TrialRecord& record : *records) check_point(record, shard_folder(request_.folder));
  const ShardRange range = plan_.range(shard);
  committed_[shard] = records->size() >= range.count;
  for (TrialRecord& record : *records) take(std::move(record));
  if (committed_[shard]) pending_.erase(shard);
}

void Ledger::load_journal(const fs::path& journal, bool repair) {
  JournalContent content = repair ? recover_journal(journal) : read_journal(journal);
  for (auto& [index, record] : content.records) {
    check_point(record, journal);
    take(std::move(record));
  }
  if (!repair || content.damaged_count == 0) return;
  damaged_ += content.damaged_count;
  log_line("campaign", journal.string() + ": " + std::to_string(content.damaged_count) +
                           " unreadable lines are set aside in " + journal.filename().string() +
                           ".damaged; their trials are computed again");
}

void Ledger::check_point(const TrialRecord& record, const fs::path& file) const {
  const std::uint64_t index = record.point.index;
  if (index < request_.design.size() && !is_same(record.point, request_.design[index]))
    throw InputError(file.string() + ": trial " + std::to_string(index) +
                     " was computed at another point than this design's; choose another folder");
}

void Ledger::take(TrialRecord record) {
  const std::uint64_t index = record.point.index;
  if (index >= request_.design.size()) {
    beyond_.emplace(index, std::move(record));
    return;
  }
  const std::uint64_t shard = plan_.shard_of(index);
  if (!looked_at_[shard] || done_[index]) return;
  done_[index] = true;
  ++done_count_;
  count_outcome(record, by_verdict_, by_reason_);
  pending_[shard].emplace(index, std::move(record));
}

std::vector<const DesignPoint*> Ledger::missing() const {
  std::vector<const DesignPoint*> todo;
  for (const std::uint64_t shard : shards_) {
    const ShardRange range = plan_.range(shard);
    for (std::uint64_t i = range.first; i < range.first + range.count; ++i)
      if (!done_[i]) todo.push_back(&request_.design[i]);
  }
  return todo;
}

void Ledger::add(TrialRecord record) {
  const std::uint64_t shard = plan_.shard_of(record.point.index);
  take(std::move(record));
  commit_if_whole(shard);
}

void Ledger::commit_if_whole(std::uint64_t shard) {
  const auto found = pending_.find(shard);
  if (found == pending_.end() || found->second.size() != plan_.range(shard).count) return;
  std::vector<TrialRecord> records;
  for (const auto& [index, record] : found->second) records.push_back(record);
  commit_shard(request_.folder, shard, records, request_.provenance, campaign_);
  committed_[shard] = true;
  pending_.erase(found);
}

void Ledger::gather_journals() const {
  std::vector<TrialRecord> rows;
  for (const auto& [shard, records] : pending_)
    for (const auto& [index, record] : records) rows.push_back(record);
  for (const auto& [index, record] : beyond_) rows.push_back(record);
  const fs::path& folder = request_.folder;
  const std::vector<fs::path> before = journals_of(folder);
  if (before.empty() && rows.empty()) return;
  write_journal(journal_path(folder), rows);
  std::error_code ignored;
  for (const fs::path& journal : before)
    if (journal != journal_path(folder)) fs::remove(journal, ignored);
  if (rows.empty()) fs::remove(journal_path(folder), ignored);
}

void Ledger::write_dataset() const {
  TrialColumns columns(request_.design.size());
  for (const std::uint64_t shard : shards_) {
    const ShardRange range = plan_.range(shard);
    const auto records = read_shard(request_.folder, shard, campaign_);
    if (!records || records->size() < range.count)
      throw InputError(shard_folder(request_.folder).string() + ": shard " + std::to_string(shard) +
                       " has gone; run the same command again");
    for (std::uint64_t i = 0; i < range.count; ++i) columns.append((*records)[i]);
  }
  const std::string image = dataset_image(std::move(columns), request_.provenance);
  const fs::path path = dataset_path(request_.folder);
  std::error_code ec;
  if (fs::exists(path, ec) && fs::file_size(path, ec) == image.size() && file_hash(path) == content_hash(image)) return;
  write_file_atomically(path, image);
}

}  // namespace gonogo::campaign
