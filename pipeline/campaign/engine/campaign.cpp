#include "pipeline/campaign/engine/campaign.h"

#include <numeric>
#include <set>

#include "base/cores.h"
#include "base/error.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/progress.h"
#include "pipeline/campaign/engine/coordinator.h"
#include "pipeline/campaign/engine/journal.h"
#include "pipeline/campaign/engine/ledger.h"
#include "pipeline/campaign/engine/pace.h"
#include "pipeline/campaign/engine/process_crew.h"

namespace gonogo::campaign {
namespace fs = std::filesystem;
namespace {

std::vector<std::uint64_t> all_shards(const ShardPlan& plan) {
  std::vector<std::uint64_t> shards(plan.count());
  std::iota(shards.begin(), shards.end(), std::uint64_t(0));
  return shards;
}

/// Hash of all that the trials depend on.
std::string campaign_id(const CampaignRequest& request) {
  std::string text;
  for (const auto& [name, value] : request.depends_on) text.append(name).append("\n").append(value).append("\n");
  return content_hash(text);
}

std::vector<std::string> worker_command(const CampaignRequest& request, std::size_t slot) {
  std::vector<std::string> words = request.worker_command;
  if (request.checkpoint_every > 0) {
    words.insert(words.end(), {"--checkpoints", running_folder(request.folder).string()});
    words.insert(words.end(), {"--checkpoint-every", std::to_string(request.checkpoint_every)});
  }
  if (request.gpus > 0) words.insert(words.end(), {"--gpu", std::to_string(slot % std::size_t(request.gpus))});
  return words;
}

std::unique_ptr<Crew> make_crew(const CampaignRequest& request, std::size_t todo) {
  const int cores = threads_or_all(0);
  const std::size_t workers = std::size_t(std::max(1, request.workers > 0 ? request.workers : cores));
  if (request.crew) return request.crew(todo);
  return process_crew(std::min(workers, todo), [&request](std::size_t slot) { return worker_command(request, slot); });
}

/// Makes the folder where workers save trials, or removes what a coordinator finds there of trials that are done.
void prepare_running_folder(const CampaignRequest& request, const std::vector<const DesignPoint*>& todo, bool alone) {
  const fs::path running = running_folder(request.folder);
  std::set<fs::path> wanted;
  for (const DesignPoint* point : todo) wanted.insert(saved_trial_path(running, point->index));
  if (request.checkpoint_every > 0) create_folder(running);
  std::error_code ignored;
  std::size_t saved = 0;
  for (const auto& entry : fs::directory_iterator(running, ignored)) {
    if (wanted.count(entry.path()))
      ++saved;
    else if (alone && entry.path().extension() == ".h5")
      fs::remove(entry.path(), ignored);
  }
  if (saved > 0) log_line("campaign", "trials that go on from where they were saved: " + std::to_string(saved));
}

struct Work {
  const CampaignRequest& request;
  Ledger& ledger;
  fs::path journal;
  std::size_t trials;  // of the shards that are worked on
  bool alone;          // in the folder
};

/// Computes what the ledger misses; returns how many workers died.
std::size_t compute(const Work& work) {
  const CampaignRequest& request = work.request;
  const std::vector<const DesignPoint*> todo = work.ledger.missing();
  if (todo.empty()) return 0;
  prepare_running_folder(request, todo, work.alone);
  Journal journal(work.journal);
  const std::size_t reused = work.ledger.done();
  Progress progress("campaign", "trials", work.trials);
  PaceWriter pace(request.folder, work.journal.stem().string());
  const auto finished = [&](TrialRecord record) {
    journal.append(record);
    const std::uint64_t index = record.point.index;
    work.ledger.add(std::move(record));
    std::error_code ignored;
    fs::remove(saved_trial_path(running_folder(request.folder), index), ignored);
    pace.trial_done();
    progress.update(work.ledger.done(), counts_line(work.ledger.by_verdict(), work.ledger.by_reason()), reused);
  };
  const auto idle = [&] {
    journal.flush_if_due();
    pace.tell_if_due();
  };
  const std::unique_ptr<Crew> crew = make_crew(request, todo.size());
  const std::size_t deaths =
      compute_trials({.todo = todo, .crew = crew.get(), .places = request.places, .finished = finished, .idle = idle});
  journal.flush();
  return deaths;
}

/// All rows that no shard holds, in one journal.
void gather_journals(const fs::path& folder, const Ledger& ledger) {
  const std::vector<fs::path> before = journals_of(folder);
  const std::vector<TrialRecord> rows = ledger.uncommitted();
  if (before.empty() && rows.empty()) return;
  write_journal(journal_path(folder), rows);
  std::error_code ignored;
  for (const fs::path& journal : before)
    if (journal != journal_path(folder)) fs::remove(journal, ignored);
  if (rows.empty()) fs::remove(journal_path(folder), ignored);
}

CampaignSummary summary_of(const Ledger& ledger) {
  CampaignSummary summary;
  summary.trials = ledger.done();
  summary.damaged = ledger.damaged();
  summary.by_verdict = ledger.by_verdict();
  summary.by_reason = ledger.by_reason();
  return summary;
}

/// Reads every shard once more, against its manifest, and writes the dataset unless it is there already.
void merge(const CampaignRequest& request, const ShardPlan& plan) {
  TrialColumns columns(request.design.size());
  for (std::uint64_t shard = 0; shard < plan.count(); ++shard) {
    const ShardRange range = plan.range(shard);
    const auto records = read_shard(request.folder, shard, campaign_id(request));
    if (!records || records->size() < range.count)
      throw InputError(shard_folder(request.folder).string() + ": shard " + std::to_string(shard) +
                       " has gone; run the same command again");
    for (std::uint64_t i = 0; i < range.count; ++i) columns.append((*records)[i]);
  }
  const std::string image = dataset_image(std::move(columns), request.provenance);
  const fs::path path = dataset_path(request.folder);
  std::error_code ec;
  if (fs::exists(path, ec) && fs::file_size(path, ec) == image.size() && file_hash(path) == content_hash(image)) return;
  write_file_atomically(path, image);
}

/// What a coordinator finds in the folder that it holds.
Ledger recover(const CampaignRequest& request, const ShardPlan& plan) {
  remove_partial_files(request.folder);
  forget_paces(request.folder);
  create_folder(request.folder / "trials");
  Ledger ledger(request.folder, request.design, plan, request.provenance, campaign_id(request), all_shards(plan));
  ledger.load_shards();
  for (const fs::path& journal : journals_of(request.folder)) ledger.load_journal(journal, true);
  ledger.commit_whole();
  gather_journals(request.folder, ledger);
  return ledger;
}

ShardPlan claim(const CampaignRequest& request) {
  const Claim claim = claim_folder(
      request.folder, {request.design.size(), std::max<std::size_t>(1, request.trials_per_shard)}, request.depends_on);
  return {request.design.size(), claim.trials_per_shard};
}

CampaignSummary finish(const CampaignRequest& request, const ShardPlan& plan, const Ledger& ledger,
                       std::size_t reused) {
  gather_journals(request.folder, ledger);
  std::error_code not_empty;  // a file that was set aside stays
  fs::remove(running_folder(request.folder), not_empty);
  merge(request, plan);
  CampaignSummary summary = summary_of(ledger);
  summary.dataset = dataset_path(request.folder);
  summary.reused = reused;
  summary.computed = summary.trials - reused;
  return summary;
}

}  // namespace

CampaignSummary run_campaign(const CampaignRequest& request) {
  const CampaignLock lock(request.folder, FolderUse::coordinator);
  const ShardPlan plan = claim(request);
  Ledger ledger = recover(request, plan);
  const std::size_t reused = ledger.done();
  std::size_t deaths = 0;
  if (reused < request.design.size()) {
    request.prepare();
    deaths = compute({.request = request,
                      .ledger = ledger,
                      .journal = journal_path(request.folder),
                      .trials = request.design.size(),
                      .alone = true});
  }
  CampaignSummary summary = finish(request, plan, ledger, reused);
  summary.worker_deaths = deaths;
  return summary;
}

CampaignSummary run_campaign_task(const CampaignRequest& request, std::uint64_t task, std::uint64_t tasks) {
  const CampaignLock lock(request.folder, FolderUse::tasks);
  const Claim claim = require_claim(request.folder, request.design.size(), request.depends_on);
  const ShardPlan plan{request.design.size(), claim.trials_per_shard};
  create_folder(request.folder / "trials");
  CampaignSummary total;
  for (std::uint64_t shard = task; shard < plan.count(); shard += tasks) {
    const fs::path journal = journal_path(request.folder, shard);
    const std::optional<FileLock> ours = FileLock::take(journal.string() + ".lock", FileLock::Kind::exclusive);
    if (!ours) {
      log_line("campaign", "shard " + std::to_string(shard) + " is being computed by another task");
      continue;
    }
    Ledger ledger(request.folder, request.design, plan, request.provenance, campaign_id(request), {shard});
    ledger.load_shards();
    for (const fs::path& other : journals_of(request.folder)) ledger.load_journal(other, other == journal);
    ledger.commit_whole();
    const std::size_t reused = ledger.done();
    total.worker_deaths += compute({.request = request,
                                    .ledger = ledger,
                                    .journal = journal,
                                    .trials = std::size_t(plan.range(shard).count),
                                    .alone = false});
    std::error_code ignored;
    fs::remove(journal, ignored);
    const CampaignSummary part = summary_of(ledger);
    total.trials += part.trials;
    total.reused += reused;
    total.computed += part.trials - reused;
    total.damaged += part.damaged;
    for (const auto& [name, number] : part.by_verdict) total.by_verdict[name] += number;
    for (const auto& [name, number] : part.by_reason) total.by_reason[name] += number;
  }
  return total;
}

std::vector<std::uint64_t> open_campaign(const CampaignRequest& request) {
  const CampaignLock lock(request.folder, FolderUse::coordinator);
  const ShardPlan plan = claim(request);
  const Ledger ledger = recover(request, plan);
  std::set<std::uint64_t> shards;
  for (const DesignPoint* point : ledger.missing()) shards.insert(plan.shard_of(point->index));
  if (!shards.empty()) request.prepare();
  return {shards.begin(), shards.end()};
}

CampaignSummary collect_campaign(const CampaignRequest& request) {
  const CampaignLock lock(request.folder, FolderUse::coordinator);
  const Claim claim = require_claim(request.folder, request.design.size(), request.depends_on);
  const ShardPlan plan{request.design.size(), claim.trials_per_shard};
  const Ledger ledger = recover(request, plan);
  if (const auto missing = ledger.missing(); !missing.empty()) {
    std::set<std::uint64_t> shards;
    for (const DesignPoint* point : missing) shards.insert(plan.shard_of(point->index));
    throw InputError(request.folder.string() + ": " + std::to_string(missing.size()) + " trials of " +
                     std::to_string(shards.size()) + " shards are missing; gonogo campaign submit computes them");
  }
  return finish(request, plan, ledger, ledger.done());
}

CampaignStatus campaign_status(const fs::path& folder) {
  CampaignStatus status;
  const Claim claim = read_claim(folder);
  const ShardPlan plan{claim.trials, claim.trials_per_shard};
  status.trials = claim.trials;
  status.shards = plan.count();
  status.use = folder_use(folder);
  std::vector<bool> committed(plan.count(), false);
  for (std::uint64_t shard = 0; shard < plan.count(); ++shard) {
    try {
      const auto manifest = read_manifest(folder, shard);
      if (!manifest || manifest->range.count < plan.range(shard).count) continue;
      committed[shard] = true;
      ++status.committed_shards;
      status.done += plan.range(shard).count;
      for (const auto& [name, number] : manifest->by_verdict) status.by_verdict[name] += number;
      for (const auto& [name, number] : manifest->by_reason) status.by_reason[name] += number;
    } catch (const InputError&) {
      ++status.damaged;
    }
  }
  std::set<std::uint64_t> seen;
  for (const fs::path& journal : journals_of(folder)) {
    const JournalContent content = read_journal(journal);
    status.damaged += content.damaged_count;
    for (const auto& [index, record] : content.records) {
      if (index >= status.trials || committed[plan.shard_of(index)] || !seen.insert(index).second) continue;
      ++status.done;
      count_outcome(record, status.by_verdict, status.by_reason);
    }
  }
  if (status.use != FolderUse::none) status.rate = total_pace(folder);
  if (status.rate > 0) status.seconds_left = double(status.trials - status.done) / status.rate;
  return status;
}

std::string counts_line(const Counts& by_verdict, const Counts& by_reason) {
  std::string text;
  for (const VerdictInfo& verdict : contract().verdicts) {
    const auto found = by_verdict.find(verdict.name);
    if (found == by_verdict.end()) continue;
    text += (text.empty() ? "" : ", ") + std::to_string(found->second) + " " + verdict.name;
    if (verdict.code != int(Verdict::no_go)) continue;
    std::string reasons;
    for (const ReasonInfo& reason : contract().reasons) {
      const auto share = by_reason.find(reason.name);
      const bool of_no_go = reason.verdicts == std::vector<std::string>{verdict.name};
      if (share != by_reason.end() && of_no_go)
        reasons += (reasons.empty() ? "" : ", ") + std::to_string(share->second) + " " + reason.name;
    }
    text += " (" + reasons + ")";
  }
  return text;
}

}  // namespace gonogo::campaign
