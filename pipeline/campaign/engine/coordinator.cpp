#include "pipeline/campaign/engine/coordinator.h"

#include <algorithm>
#include <chrono>
#include <deque>
#include <limits>
#include <map>

#include "base/cancel.h"
#include "base/error.h"
#include "base/progress.h"
#include "pipeline/campaign/dataset/row.h"
#include "pipeline/campaign/engine/journal.h"
#include "pipeline/campaign/engine/worker.h"

namespace gonogo::campaign {
namespace {

constexpr int kMaxCrashes = 2;  // of workers that had one trial alone, by their own code
constexpr int kMaxKills = 5;    // of such workers, from outside
constexpr int kPollMilliseconds = 200;
constexpr double kShortTrial = 1;  // [s] of a worker

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
  explicit Pool(const PoolRequest& request)
      : request_(request), todo_(request.todo.begin(), request.todo.end()), held_(request.crew->size()) {}

  std::size_t run() {
    while (!todo_.empty() || busy()) {
      stop_if_cancelled();
      for (std::size_t worker = 0; worker < held_.size(); ++worker) hand_out(worker);
      for (const CrewNews& news : request_.crew->wait(kPollMilliseconds)) hear(news);
      request_.idle();
    }
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
      request_.crew->send(worker, seal_line(to_row(*todo_.front())));
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
    request_.finished(std::move(*record));
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

  const PoolRequest& request_;
  std::deque<const DesignPoint*> todo_;
  std::vector<Trials> held_;                      // by worker
  std::map<std::uint64_t, Deaths> deaths_;        // by index of the trial
  std::map<std::uint64_t, std::size_t> company_;  // by index; of trials whose worker crashed, see max_beside
  std::size_t death_count_ = 0, finished_count_ = 0;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace

std::size_t compute_trials(const PoolRequest& request) { return Pool(request).run(); }

}  // namespace gonogo::campaign
