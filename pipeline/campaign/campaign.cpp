#include "pipeline/campaign/campaign.h"

#include <set>
#include <thread>

#include "base/error.h"
#include "base/file.h"
#include "base/progress.h"
#include "pipeline/campaign/coordinator.h"
#include "pipeline/campaign/folder.h"
#include "pipeline/campaign/journal.h"
#include "pipeline/dataset/row.h"

namespace gonogo::pipeline {
namespace fs = std::filesystem;
namespace {

using Counts = std::map<std::string, std::size_t>;

void count(const TrialRecord& record, Counts& by_verdict, Counts& by_reason) {
  ++by_verdict[contract().info(record.verdict).name];
  ++by_reason[contract().info(record.reason).name];
}

/// Rows of trials that are not the design's are worthless: they get lost here, and their trials are computed again.
RecordsByIndex matching(RecordsByIndex records, const std::vector<DesignPoint>& design, std::size_t& foreign) {
  for (auto at = records.begin(); at != records.end();) {
    const bool beyond = at->first >= design.size();  // of a longer design in the same folder
    const bool differs = !beyond && to_row(at->second.point) != to_row(design[at->first]);
    foreign += differs;
    at = beyond || differs ? records.erase(at) : std::next(at);
  }
  return records;
}

std::vector<const DesignPoint*> missing(const std::vector<DesignPoint>& design, const RecordsByIndex& records) {
  std::vector<const DesignPoint*> todo;
  for (const DesignPoint& point : design)
    if (!records.count(point.index)) todo.push_back(&point);
  return todo;
}

RecordsByIndex recover(const CampaignRequest& request, CampaignSummary& summary) {
  create_folder(request.folder / "trials");
  const fs::path path = journal_path(request.folder);
  JournalContent content = recover_journal(path);
  std::size_t foreign = 0;
  RecordsByIndex records = matching(std::move(content.records), request.design, foreign);
  if (foreign > 0)
    throw InputError(path.string() + ": " + std::to_string(foreign) +
                     " trials were computed at other points than this design's; choose another folder");
  summary.damaged = content.damaged_count;
  if (summary.damaged > 0)
    log_line("campaign", path.string() + ": " + std::to_string(summary.damaged) +
                             " unreadable lines are set aside in " + path.filename().string() +
                             ".damaged; their trials are computed again");
  return records;
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

/// Makes the folder where workers save trials, or removes what lies there of trials that are not missing.
void prepare_running_folder(const CampaignRequest& request, const std::vector<const DesignPoint*>& todo) {
  const fs::path running = running_folder(request.folder);
  std::set<fs::path> wanted;
  for (const DesignPoint* point : todo) wanted.insert(saved_trial_path(running, point->index));
  if (request.checkpoint_every > 0) create_folder(running);
  std::error_code ignored;
  std::size_t saved = 0;
  for (const auto& entry : fs::directory_iterator(running, ignored)) {
    if (wanted.count(entry.path()))
      ++saved;
    else if (entry.path().extension() == ".h5")
      fs::remove(entry.path(), ignored);
  }
  if (saved > 0) log_line("campaign", "trials that go on from where they were saved: " + std::to_string(saved));
}

void compute(const CampaignRequest& request, std::vector<const DesignPoint*> todo, RecordsByIndex& records,
             CampaignSummary& summary) {
  request.prepare();
  prepare_running_folder(request, todo);
  Journal journal(journal_path(request.folder));
  Counts by_verdict, by_reason;
  for (const auto& [index, record] : records) count(record, by_verdict, by_reason);
  const std::size_t reused = records.size();
  Progress progress("campaign", "trials", request.design.size());
  const int cores = int(std::max(1u, std::thread::hardware_concurrency()));
  summary.worker_deaths =
      compute_trials({.todo = std::move(todo),
                      .worker_command = [&](std::size_t slot) { return worker_command(request, slot); },
                      .workers = request.workers > 0 ? request.workers : cores,
                      .places = request.places,
                      .finished =
                          [&](TrialRecord record) {
                            journal.append(record);
                            count(record, by_verdict, by_reason);
                            const std::uint64_t index = record.point.index;
                            records.emplace(index, std::move(record));
                            std::error_code ignored;
                            fs::remove(saved_trial_path(running_folder(request.folder), index), ignored);
                            progress.update(records.size(), counts_line(by_verdict, by_reason), reused);
                          },
                      .idle = [&] { journal.flush_if_due(); }});
  journal.flush();
  std::error_code not_empty;  // a file that was set aside stays
  fs::remove(running_folder(request.folder), not_empty);
}

void store_dataset(const fs::path& path, const CampaignRequest& request, const RecordsByIndex& records) {
  Dataset dataset{.records = {}, .provenance = request.provenance};
  for (const auto& [index, record] : records) dataset.records.push_back(record);
  const std::string image = dataset_image(dataset);
  std::error_code ec;
  if (fs::exists(path, ec) && read_file(path) == image) return;
  write_file_atomically(path, image);
}

}  // namespace

CampaignSummary run_campaign(const CampaignRequest& request) {
  const FolderLock lock(request.folder);
  remove_partial_files(request.folder);
  claim_folder(request.folder, request.design.size(), request.depends_on);
  CampaignSummary summary;
  RecordsByIndex records = recover(request, summary);
  summary.reused = records.size();
  std::vector<const DesignPoint*> todo = missing(request.design, records);
  summary.computed = todo.size();
  if (!todo.empty()) compute(request, std::move(todo), records, summary);
  summary.trials = records.size();
  for (const auto& [index, record] : records) count(record, summary.by_verdict, summary.by_reason);
  summary.dataset = dataset_path(request.folder);
  store_dataset(summary.dataset, request, records);
  return summary;
}

CampaignStatus campaign_status(const fs::path& folder) {
  CampaignStatus status;
  status.trials = claimed_trials(folder);
  status.running = is_locked(folder);
  const JournalContent content = read_journal(journal_path(folder));
  status.damaged = content.damaged_count;
  for (const auto& [index, record] : content.records) {
    if (index >= status.trials) continue;
    ++status.done;
    count(record, status.by_verdict, status.by_reason);
  }
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

}  // namespace gonogo::pipeline
