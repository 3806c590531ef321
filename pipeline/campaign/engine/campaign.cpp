#include "pipeline/campaign/engine/campaign.h"

#include <algorithm>
#include <chrono>
#include <deque>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "base/error.h"
#include "base/files/file.h"
#include "base/parallel/for_each.h"
#include "base/progress.h"
#include "pipeline/campaign/dataset/row.h"
#include "pipeline/campaign/engine/ledger.h"

namespace gonogo::campaign {
namespace fs = std::filesystem;
namespace {

std::set<std::uint64_t> shards_of(const std::vector<const DesignPoint*>& points, const ShardPlan& plan) {
  std::set<std::uint64_t> shards;
  for (const DesignPoint* point : points) shards.insert(plan.shard_of(point->index));
  return shards;
}

CampaignSummary summary_of(const Ledger& ledger, std::size_t reused, std::size_t deaths) {
  return {.dataset = {},
          .trials = ledger.done(),
          .computed = ledger.done() - reused,
          .reused = reused,
          .damaged = ledger.damaged(),
          .worker_deaths = deaths,
          .by_verdict = ledger.by_verdict(),
          .by_reason = ledger.by_reason()};
}

void add_counts(Counts& sum, const Counts& part) {
  for (const auto& [name, number] : part) sum[name] += number;
}

// Computing what the ledger misses.

constexpr int kMaxCrashes = 2;  // of workers that had one trial alone, by their own code
constexpr int kMaxKills = 5;    // of such workers, from outside
constexpr int kPollMilliseconds = 200;
constexpr double kShortTrial = 1;  // [s] of a worker

std::unique_ptr<Crew> make_crew(const CampaignRequest& request, std::size_t todo) {
  if (request.crew) return request.crew(todo);
  const std::size_t workers = std::size_t(std::max(1, threads_or_all(request.workers)));
  return process_crew(std::min(workers, todo), [&request](std::size_t slot) {
    std::vector<std::string> words = request.worker_command;
    if (request.checkpoint_every > 0) {
      words.insert(words.end(), {"--checkpoints", running_folder(request.folder).string()});
      words.insert(words.end(), {"--checkpoint-every", std::to_string(request.checkpoint_every)});
    }
    if (request.gpus > 0) words.insert(words.end(), {"--gpu", std::to_string(slot % std::size_t(request.gpus))});
    return words;
  });
}

struct Deaths {
  int crashes = 0, kills = 0, kills_in_company = 0;
};

/// The text of `line` behind `word` when the line starts with it and its hash holds.
std::optional<std::string> sealed_text(const std::string& line, const std::string& word) {
  if (line.compare(0, word.size(), word) != 0) return std::nullopt;
  const std::optional<std::string_view> text = unseal_line(std::string_view(line).substr(word.size()));
  if (!text) return std::nullopt;
  return std::string(*text);
}

/// Hands trials out to a crew of workers, hears their records and commits them. A dead worker is replaced and its
/// trials are done again.
///
/// The trial that kills workers is found by halving: after a crash, or a second kill from outside, the trials that the
/// worker had get at most half as many others beside them. A trial whose workers crash twice while it is alone, or are
/// killed five times, stops the campaign. It never becomes a result: results must not depend on which workers died.
class Coordinator {
 public:
  /// `trials`: of the shards that are worked on, for progress.
  Coordinator(const CampaignRequest& request, Ledger& ledger, const std::vector<const DesignPoint*>& todo,
              const fs::path& journal, std::size_t trials)
      : request_(request),
        ledger_(ledger),
        reused_(ledger.done()),
        journal_(journal),
        progress_("campaign", "trials", trials),
        pace_(request.folder, journal.stem().string()),
        crew_(make_crew(request, todo.size())),
        todo_(todo.begin(), todo.end()),
        held_(crew_->size()) {}

  /// Computes every trial and returns how many workers died. Throws InputError or DeviceError with the worker's
  /// sentence when a trial reports a fault that all would meet, InputError for a worker of another version of the
  /// program, Cancelled on Ctrl-C.
  std::size_t run() {
    while (!todo_.empty() || busy()) {
      stop_if_cancelled();
      for (std::size_t worker = 0; worker < held_.size(); ++worker) hand_out(worker);
      for (const CrewNews& news : crew_->wait(kPollMilliseconds)) hear(news);
      journal_.flush_if_due();
      pace_.tell_if_due();
    }
    journal_.flush();
    return death_count_;
  }

 private:
  using Trials = std::vector<const DesignPoint*>;  // that a worker was given and did not answer

  bool busy() const {
    return std::any_of(held_.begin(), held_.end(), [](const Trials& trials) { return !trials.empty(); });
  }

  void hand_out(std::size_t worker) {
    while (!todo_.empty() && may_have(held_[worker], *todo_.front())) {
      held_[worker].push_back(todo_.front());
      crew_->send(worker, seal_line(to_row(*todo_.front())));
      todo_.pop_front();
    }
  }

  /// Short trials lie ready at their workers, so that none waits for the coordinator between two of them. Not long
  /// ones, nor the last ones: they would wait for one worker while another has nothing to do.
  std::size_t ahead() const {
    const std::size_t workers = held_.size();
    if (finished_count_ < 2 * workers || todo_.size() < 4 * workers) return 0;
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    return seconds * double(workers) / double(finished_count_) < kShortTrial ? 1 : 0;
  }

  bool may_have(const Trials& held, const DesignPoint& next) const {
    std::size_t room = std::min(std::size_t(std::max(1, request_.places)) + ahead(), max_beside(next));
    if (!company_.empty())
      for (const DesignPoint* trial : held) room = std::min(room, max_beside(*trial));
    return held.size() < room;
  }

  /// Trials that a worker may have together with this one.
  std::size_t max_beside(const DesignPoint& trial) const {
    const auto found = company_.find(trial.index);
    return found == company_.end() ? std::numeric_limits<std::size_t>::max() : found->second;
  }

  void hear(const CrewNews& news) {
    for (const std::string& line : news.lines) take_answer(held_[news.worker], line);
    if (news.gone) bury(news);
  }

  void take_answer(Trials& held, const std::string& line) {
    if (const auto program = sealed_text(line, kHelloWord)) return require_same_program(*program);
    if (const auto sentence = sealed_text(line, kRefusedWord)) throw InputError(*sentence);
    if (const auto sentence = sealed_text(line, kFailedWord)) throw DeviceError(*sentence);
    const std::optional<std::string> row = sealed_text(line, kTrialWord);
    std::optional<TrialRecord> record = row ? parse_record(*row) : std::nullopt;
    const auto trial = record ? find(held, record->point) : held.end();
    if (trial == held.end())
      throw DeviceError("campaign: a worker answered with a line that is none of its trials: " + line);
    held.erase(trial);
    ++finished_count_;
    finish(std::move(*record));
  }

  static void require_same_program(const std::string& program) {
    if (program != worker_program())
      throw InputError("campaign: a worker is another version of the program (" + program + ") than its coordinator (" +
                       worker_program() + "); install one version everywhere");
  }

  static Trials::iterator find(Trials& held, const DesignPoint& point) {
    return std::find_if(held.begin(), held.end(), [&](const DesignPoint* trial) {
      return trial->index == point.index && to_row(*trial) == to_row(point);
    });
  }

  /// Commits the trial, in the order in which trials end.
  void finish(TrialRecord record) {
    const std::uint64_t index = record.point.index;
    journal_.append(record);
    ledger_.add(std::move(record));
    std::error_code ignored;
    fs::remove(saved_trial_path(running_folder(request_.folder), index), ignored);
    pace_.trial_done();
    progress_.update(ledger_.done(), counts_line(ledger_.by_verdict(), ledger_.by_reason()), reused_);
  }

  void bury(const CrewNews& news) {
    const Trials trials = std::move(held_[news.worker]);
    held_[news.worker].clear();
    ++death_count_;
    if (trials.empty()) return;
    todo_.insert(todo_.begin(), trials.begin(), trials.end());
    const std::string others = trials.size() > 1 ? " and " + std::to_string(trials.size() - 1) + " more" : "";
    for (const DesignPoint* trial : trials) {
      Deaths& deaths = deaths_[trial->index];
      const bool alone = trials.size() == 1;
      if (alone) ++(news.killed_from_outside ? deaths.kills : deaths.crashes);
      // Being killed once says nothing about a trial; twice, the machine may be short of memory for so many.
      if (!alone && !(news.killed_from_outside && ++deaths.kills_in_company == 1))
        company_[trial->index] = std::min(max_beside(*trial), trials.size() / 2);
      stop_if_hopeless(deaths, "the worker of trial " + std::to_string(trial->index) + others + " " + news.end);
    }
    log_line("campaign", "the worker of trial " + std::to_string(trials.front()->index) + others + " " + news.end +
                             (trials.size() > 1 ? "; its trials are" : "; its trial is") + " done again");
  }

  static void stop_if_hopeless(const Deaths& deaths, const std::string& what) {
    if (deaths.crashes >= kMaxCrashes)
      throw DeviceError("campaign: " + what +
                        ", for the second time; finished trials are kept, and this one has to be " +
                        "looked into before the campaign can end");
    if (deaths.kills >= kMaxKills)
      throw DeviceError("campaign: " + what + ", like " + std::to_string(kMaxKills - 1) +
                        " before it; the machine may " +
                        "be short of memory: use fewer --workers or --places and run the same command again");
  }

  const CampaignRequest& request_;
  Ledger& ledger_;
  const std::size_t reused_;
  Journal journal_;
  Progress progress_;
  PaceWriter pace_;
  std::unique_ptr<Crew> crew_;  // ends before the journal is closed
  std::deque<const DesignPoint*> todo_;
  std::vector<Trials> held_;                      // by worker
  std::map<std::uint64_t, Deaths> deaths_;        // by index of the trial
  std::map<std::uint64_t, std::size_t> company_;  // by index; of trials whose worker crashed, see max_beside
  std::size_t death_count_ = 0, finished_count_ = 0;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Returns how many workers died. A coordinator that is `alone` removes what workers saved of trials that are done.
std::size_t compute_missing(const CampaignRequest& request, Ledger& ledger, const fs::path& journal, std::size_t trials,
                            bool alone) {
  const std::vector<const DesignPoint*> todo = ledger.missing();
  if (todo.empty()) return 0;
  const fs::path running = running_folder(request.folder);
  std::set<fs::path> wanted;
  for (const DesignPoint* point : todo) wanted.insert(saved_trial_path(running, point->index));
  std::error_code ignored;
  std::size_t saved = 0;
  for (const auto& entry : fs::directory_iterator(running, ignored)) {
    if (wanted.count(entry.path()))
      ++saved;
    else if (alone && entry.path().extension() == ".h5")
      fs::remove(entry.path(), ignored);
  }
  if (saved > 0) log_line("campaign", "trials that go on from where they were saved: " + std::to_string(saved));
  return Coordinator(request, ledger, todo, journal, trials).run();
}

/// So that snapshots need no committed shard.
void keep_origin(const CampaignRequest& request) {
  const fs::path origin = origin_path(request.folder);
  if (!fs::exists(origin)) write_dataset(origin, {.records = {}, .provenance = request.provenance});
}

CampaignSummary finish(const CampaignRequest& request, const Ledger& ledger, std::size_t reused, std::size_t deaths) {
  CampaignSummary summary = summary_of(ledger, reused, deaths);
  summary.dataset = dataset_path(request.folder);
  ledger.gather_journals();
  std::error_code not_empty;  // a file that was set aside stays
  fs::remove(running_folder(request.folder), not_empty);
  ledger.write_dataset();
  return summary;
}

}  // namespace

CampaignSummary run_campaign(const CampaignRequest& request) {
  const HeldFolder held =
      hold_folder(request.folder, {request.design.size(), request.trials_per_shard}, request.depends_on);
  keep_origin(request);
  Ledger ledger = recovered_ledger(request, held.plan);
  const std::size_t reused = ledger.done(), trials = request.design.size();
  std::size_t deaths = 0;
  if (reused < trials) {
    request.prepare();
    deaths = compute_missing(request, ledger, journal_path(request.folder), trials, true);
  }
  return finish(request, ledger, reused, deaths);
}

CampaignSummary run_campaign_task(const CampaignRequest& request, std::uint64_t task, std::uint64_t tasks) {
  const HeldFolder held =
      hold_claimed_folder(request.folder, FolderUse::tasks, request.design.size(), request.depends_on);
  const ShardPlan& plan = held.plan;
  create_folder(request.folder / "trials");
  CampaignSummary total;
  for (std::uint64_t shard = task; shard < plan.count(); shard += tasks) {
    const fs::path journal = journal_path(request.folder, shard);
    const std::optional<FileLock> ours = FileLock::take(journal.string() + ".lock", FileLock::Kind::exclusive);
    if (!ours) {
      log_line("campaign", "shard " + std::to_string(shard) + " is being computed by another task");
      continue;
    }
    Ledger ledger(request, plan, {shard});
    ledger.load(journal);
    const std::size_t reused = ledger.done();
    const std::size_t deaths = compute_missing(request, ledger, journal, std::size_t(plan.range(shard).count), false);
    std::error_code ignored;
    fs::remove(journal, ignored);
    const CampaignSummary part = summary_of(ledger, reused, deaths);
    total.trials += part.trials;
    total.reused += part.reused;
    total.computed += part.computed;
    total.damaged += part.damaged;
    total.worker_deaths += part.worker_deaths;
    add_counts(total.by_verdict, part.by_verdict);
    add_counts(total.by_reason, part.by_reason);
  }
  return total;
}

std::vector<std::uint64_t> open_campaign(const CampaignRequest& request) {
  const HeldFolder held =
      hold_folder(request.folder, {request.design.size(), request.trials_per_shard}, request.depends_on);
  keep_origin(request);
  const std::set<std::uint64_t> shards = shards_of(recovered_ledger(request, held.plan).missing(), held.plan);
  if (!shards.empty()) request.prepare();
  return {shards.begin(), shards.end()};
}

CampaignSummary collect_campaign(const CampaignRequest& request) {
  const HeldFolder held =
      hold_claimed_folder(request.folder, FolderUse::coordinator, request.design.size(), request.depends_on);
  const Ledger ledger = recovered_ledger(request, held.plan);
  if (const auto missing = ledger.missing(); !missing.empty())
    throw InputError(request.folder.string() + ": " + std::to_string(missing.size()) + " trials of " +
                     std::to_string(shards_of(missing, held.plan).size()) +
                     " shards are missing; gonogo campaign submit computes them");
  return finish(request, ledger, ledger.done(), 0);
}

CampaignStatus campaign_status(const fs::path& folder) {
  CampaignStatus status;
  const ShardPlan plan = read_claim(folder);
  status.trials = plan.trials;
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
      add_counts(status.by_verdict, manifest->by_verdict);
      add_counts(status.by_reason, manifest->by_reason);
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

Dataset campaign_snapshot(const fs::path& folder) {
  const ShardPlan plan = read_claim(folder);
  RecordsByIndex finished;
  std::optional<Provenance> provenance;
  if (fs::exists(origin_path(folder))) provenance = read_dataset(origin_path(folder)).provenance;
  for (std::uint64_t shard = 0; shard < plan.count(); ++shard) {
    const std::optional<ShardManifest> manifest = read_manifest(folder, shard);
    if (!manifest) continue;
    std::vector<TrialRecord> records = read_shard(folder, shard, manifest->campaign).value();
    for (TrialRecord& record : records) finished.emplace(record.point.index, std::move(record));
    if (!provenance) provenance = read_dataset(shard_folder(folder) / manifest->file).provenance;
  }
  if (!provenance)
    throw InputError(folder.string() +
                     ": no shard is committed yet, and an older program began it; wait until the first " +
                     std::to_string(plan.per_shard) + " trials are done");
  for (const fs::path& journal : journals_of(folder)) finished.merge(read_journal(journal).records);
  Dataset dataset{.records = {}, .provenance = *std::move(provenance)};
  for (auto& [index, record] : finished) {
    if (index != dataset.records.size()) break;
    dataset.records.push_back(std::move(record));
  }
  if (dataset.records.empty()) throw InputError(folder.string() + ": trial 0 is still missing; wait for it");
  return dataset;
}

}  // namespace gonogo::campaign
