#include "pipeline/campaign/coordinator.h"

#include <poll.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <deque>
#include <limits>
#include <map>
#include <memory>

#include "base/cancel.h"
#include "base/error.h"
#include "base/progress.h"
#include "pipeline/campaign/journal.h"
#include "pipeline/campaign/worker.h"
#include "pipeline/campaign/worker_process.h"
#include "pipeline/dataset/row.h"

namespace gonogo::pipeline {
namespace {

constexpr int kMostCrashes = 2;  // of workers that had one trial alone, by their own code
constexpr int kMostKills = 5;    // of such workers, from outside
constexpr int kPollMilliseconds = 200;

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

class Pool {
 public:
  explicit Pool(const PoolRequest& request) : request_(request), todo_(request.todo.begin(), request.todo.end()) {}

  std::size_t run() {
    const std::size_t count = std::min(std::size_t(std::max(1, request_.workers)), todo_.size());
    workers_.resize(count);
    while (!todo_.empty() || busy()) {
      stop_if_cancelled();
      for (std::size_t slot = 0; slot < count; ++slot) hand_out(slot);
      wait_for_news();
      request_.idle();
    }
    return death_count_;
  }

 private:
  bool busy() const {
    return std::any_of(workers_.begin(), workers_.end(),
                       [](const auto& worker) { return worker && !worker->trials().empty(); });
  }

  void hand_out(std::size_t slot) {
    std::unique_ptr<WorkerProcess>& worker = workers_[slot];
    while (!todo_.empty() && may_have(worker.get(), *todo_.front())) {
      if (!worker) worker = std::make_unique<WorkerProcess>(request_.worker_command(slot));
      worker->start(*todo_.front());
      todo_.pop_front();
    }
  }

  bool may_have(const WorkerProcess* worker, const DesignPoint& next) {
    const std::size_t others = worker ? worker->trials().size() : 0;
    std::size_t most = std::min(std::size_t(std::max(1, request_.places)), most_beside(next));
    if (!company_.empty() && worker)
      for (const DesignPoint* trial : worker->trials()) most = std::min(most, most_beside(*trial));
    return others < most;
  }

  /// Trials that a worker may have together with this one.
  std::size_t most_beside(const DesignPoint& trial) const {
    const auto found = company_.find(trial.index);
    return found == company_.end() ? std::numeric_limits<std::size_t>::max() : found->second;
  }

  void wait_for_news() {
    std::vector<pollfd> lines;
    std::vector<std::size_t> owner;
    for (std::size_t i = 0; i < workers_.size(); ++i) {
      if (!workers_[i]) continue;
      lines.push_back({workers_[i]->fd(), POLLIN, 0});
      owner.push_back(i);
    }
    if (::poll(lines.data(), lines.size(), kPollMilliseconds) < 0) {
      if (errno == EINTR) return;
      throw DeviceError(std::string("campaign: cannot wait for the workers: ") + std::strerror(errno));
    }
    for (std::size_t i = 0; i < lines.size(); ++i)
      if (lines[i].revents != 0) hear(workers_[owner[i]]);
  }

  void hear(std::unique_ptr<WorkerProcess>& worker) {
    const bool alive = worker->receive();
    while (const std::optional<std::string> line = worker->take_line()) take_answer(*worker, *line);
    if (!alive) bury(worker);
  }

  void take_answer(WorkerProcess& worker, const std::string& line) {
    if (const auto sentence = sealed_text(line, kRefusedWord)) throw InputError(*sentence);
    if (const auto sentence = sealed_text(line, kFailedWord)) throw DeviceError(*sentence);
    const std::optional<std::string> row = sealed_text(line, kTrialWord);
    std::optional<TrialRecord> record = row ? parse_record(*row) : std::nullopt;
    const DesignPoint* trial = record ? trial_of(worker, record->point) : nullptr;
    if (!trial) throw DeviceError("campaign: a worker answered with something else than a trial it was given: " + line);
    worker.finish(*trial);
    request_.finished(std::move(*record));
  }

  static const DesignPoint* trial_of(const WorkerProcess& worker, const DesignPoint& point) {
    for (const DesignPoint* trial : worker.trials())
      if (trial->index == point.index && to_row(*trial) == to_row(point)) return trial;
    return nullptr;
  }

  void bury(std::unique_ptr<WorkerProcess>& worker) {
    const std::vector<const DesignPoint*> trials = worker->trials();
    const int status = worker->wait_for_end();
    worker.reset();
    ++death_count_;
    if (trials.empty()) return;
    todo_.insert(todo_.begin(), trials.begin(), trials.end());
    const bool killed = killed_from_outside(status);
    const std::string others = trials.size() > 1 ? " and " + std::to_string(trials.size() - 1) + " more" : "";
    for (const DesignPoint* trial : trials) {
      Deaths& deaths = deaths_[trial->index];
      const bool alone = trials.size() == 1;
      if (alone) ++(killed ? deaths.kills : deaths.crashes);
      // Being killed once says nothing about a trial; twice, the machine may be short of memory for so many.
      if (!alone && !(killed && ++deaths.kills_in_company == 1))
        company_[trial->index] = std::min(most_beside(*trial), trials.size() / 2);
      stop_if_hopeless(deaths,
                       "the worker of trial " + std::to_string(trial->index) + others + " " + describe_end(status));
    }
    log_line("campaign", "the worker of trial " + std::to_string(trials.front()->index) + others + " " +
                             describe_end(status) + (trials.size() > 1 ? "; its trials are" : "; its trial is") +
                             " done again");
  }

  static void stop_if_hopeless(const Deaths& deaths, const std::string& what) {
    if (deaths.crashes >= kMostCrashes)
      throw DeviceError("campaign: " + what +
                        ", for the second time; finished trials are kept, and this one has to be " +
                        "looked into before the campaign can end");
    if (deaths.kills >= kMostKills)
      throw DeviceError("campaign: " + what + ", like " + std::to_string(kMostKills - 1) +
                        " before it; the machine may " +
                        "be short of memory: use fewer --workers or --places and run the same command again");
  }

  const PoolRequest& request_;
  std::deque<const DesignPoint*> todo_;
  std::vector<std::unique_ptr<WorkerProcess>> workers_;
  std::map<std::uint64_t, Deaths> deaths_;        // by index of the trial
  std::map<std::uint64_t, std::size_t> company_;  // by index; of trials whose worker crashed, see most_beside
  std::size_t death_count_ = 0;
};

}  // namespace

std::size_t compute_trials(const PoolRequest& request) { return Pool(request).run(); }

}  // namespace gonogo::pipeline
