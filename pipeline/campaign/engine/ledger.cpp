#include "pipeline/campaign/engine/ledger.h"

#include "base/error.h"
#include "base/progress.h"

namespace gonogo::campaign {
namespace fs = std::filesystem;

namespace {

bool is_same(const DesignPoint& a, const DesignPoint& b) {
  return a.index == b.index && a.seed == b.seed && a.replicate_of == b.replicate_of &&
         a.proposal_density == b.proposal_density && a.variables == b.variables;
}

}  // namespace

Ledger::Ledger(fs::path folder, const std::vector<DesignPoint>& design, ShardPlan plan, Provenance provenance,
               std::string campaign, std::vector<std::uint64_t> shards)
    : folder_(std::move(folder)),
      design_(design),
      plan_(plan),
      provenance_(std::move(provenance)),
      campaign_(std::move(campaign)),
      shards_(std::move(shards)),
      looked_at_(plan.count(), false),
      committed_(plan.count(), false),
      done_(design.size(), false) {
  for (const std::uint64_t shard : shards_) looked_at_[shard] = true;
}

void Ledger::load_shards() {
  for (const std::uint64_t shard : shards_) {
    try {
      load_shard(shard);
    } catch (const InputError& error) {
      set_shard_aside(folder_, shard);
      ++damaged_;
      log_line("campaign", std::string(error.what()) + "; shard " + std::to_string(shard) +
                               " is set aside as *.damaged and its trials are computed again");
    }
  }
}

void Ledger::load_shard(std::uint64_t shard) {
  std::optional<std::vector<TrialRecord>> records = read_shard(folder_, shard, campaign_);
  if (!records) return;
  for (const TrialRecord& record : *records) check_point(record, shard_folder(folder_));
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
  if (index < design_.size() && !is_same(record.point, design_[index]))
    throw InputError(file.string() + ": trial " + std::to_string(index) +
                     " was computed at another point than this design's; choose another folder");
}

void Ledger::take(TrialRecord record) {
  const std::uint64_t index = record.point.index;
  if (index >= design_.size()) {
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
      if (!done_[i]) todo.push_back(&design_[i]);
  }
  return todo;
}

void Ledger::add(TrialRecord record) {
  const std::uint64_t shard = plan_.shard_of(record.point.index);
  take(std::move(record));
  if (pending_[shard].size() == plan_.range(shard).count) commit(shard);
}

void Ledger::commit_whole() {
  for (const std::uint64_t shard : shards_) {
    const auto found = pending_.find(shard);
    if (found != pending_.end() && found->second.size() == plan_.range(shard).count) commit(shard);
  }
}

void Ledger::commit(std::uint64_t shard) {
  std::vector<TrialRecord> records;
  for (auto& [index, record] : pending_.at(shard)) records.push_back(record);
  commit_shard(folder_, shard, records, provenance_, campaign_);
  committed_[shard] = true;
  pending_.erase(shard);
}

std::vector<TrialRecord> Ledger::uncommitted() const {
  std::vector<TrialRecord> records;
  for (const auto& [shard, rows] : pending_)
    for (const auto& [index, record] : rows) records.push_back(record);
  for (const auto& [index, record] : beyond_) records.push_back(record);
  return records;
}

}  // namespace gonogo::campaign
