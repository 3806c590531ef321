// A campaign of cheap trials, as a program that tests can kill.
//   campaign_program run|mpi|collect <folder> <points> <workers> <ms per trial> <behaviour> <places> [<per shard>]
//   campaign_program submit <the same>
//   campaign_program task <the same> --task <k> --tasks <n>
//   campaign_program worker <ms per trial> <behaviour> <places>
// Behaviours: "normal"; "crash:<index>" and "refuse:<index>" at that trial; "print" writes to standard output too;
// "old" greets as another version would. <per shard> trials are committed together; 64 without it.
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>

#include "base/error.h"
#include "base/progress.h"
#include "pipeline/campaign/engine/cluster/slurm.h"
#include "pipeline/campaign/engine/ledger.h"
#include "pipeline/campaign/engine/worker.h"
#include "tests/fault/cheap_campaign.h"
#include "tests/support/trials.h"
#ifdef GONOGO_WITH_MPI
#include "pipeline/campaign/engine/cluster/mpi_crew.h"
#endif

namespace gonogo::campaign {

namespace {

TrialRecord misbehave(const DesignPoint& point, int milliseconds, const std::string& behaviour) {
  const std::string index = std::to_string(point.index);
  if (behaviour == "crash:" + index) std::abort();
  if (behaviour == "refuse:" + index) throw InputError("soil.json: cohesion: value -1 is outside the allowed range");
  if (behaviour == "print") std::puts("a library talks to standard output");
  std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds));
  return closed_form_trial(point);
}

/// Trials side by side that end in another order than they began.
class Shuffle : public TrialEngine {
 public:
  Shuffle(int milliseconds, std::string behaviour, std::size_t places)
      : milliseconds_(milliseconds), behaviour_(std::move(behaviour)), places_(places) {}
  bool has_room() const override { return points_.size() < places_; }
  bool is_running() const override { return !points_.empty(); }
  void start(const DesignPoint& point) override { points_.push_back(point); }
  std::vector<TrialRecord> advance() override {
    const auto next = points_.begin() + std::ptrdiff_t(++count_ % points_.size());
    const DesignPoint point = *next;
    points_.erase(next);
    return {misbehave(point, milliseconds_, behaviour_)};
  }

 private:
  int milliseconds_;
  std::string behaviour_;
  std::size_t places_, count_ = 0;
  std::vector<DesignPoint> points_;
};

void work(int milliseconds, const std::string& behaviour, int places) {
  Shuffle trials(milliseconds, behaviour, std::size_t(places));
  run_worker(trials);
}

CampaignRequest request_of(const std::vector<std::string>& words) {
  CampaignRequest request = cheap_campaign(words.at(2), std::stoi(words.at(3)));
  request.workers = std::stoi(words.at(4));
  request.places = std::stoi(words.at(7));
  request.worker_command = {"/proc/self/exe", "worker", words.at(5), words.at(6), words.at(7)};
  request.trials_per_shard = words.size() > 8 ? std::size_t(std::stoi(words.at(8))) : 64;
  return request;
}

void print(const CampaignSummary& summary) {
  std::printf("trials %zu computed %zu reused %zu damaged %zu\n", summary.trials, summary.computed, summary.reused,
              summary.damaged);
}

void submit(const std::vector<std::string>& words) {
  std::vector<std::string> task = words;
  task[0] = std::filesystem::read_symlink("/proc/self/exe");
  task[1] = "task";
  const Submission done =
      submit_campaign(request_of(words), {.tasks = 3, .task_command = task, .options = {"--cpus-per-task=1"}});
  std::printf("job %s shards %zu tasks %zu\n", done.job.c_str(), done.shards, done.tasks);
}

#ifdef GONOGO_WITH_MPI
void run_with_mpi(const std::vector<std::string>& words) {
  const MpiJob job;
  CampaignRequest request = request_of(words);
  if (job.rank() > 0) {
    Shuffle trials(std::stoi(words.at(5)), words.at(6), 1);
    return run_worker(trials, *job.worker_line());
  }
  request.crew = job.crew_maker();
  print(run_campaign(request));
}
#endif

int run(const std::vector<std::string>& words) {
  const std::string& what = words.at(1);
  if (what == "worker") {
    if (words.at(3) == "old") {
      std::printf("%s%s", kHelloWord, seal_line("0.0.1 (1234)").c_str());
      std::fflush(stdout);
    }
    work(std::stoi(words.at(2)), words.at(3), std::stoi(words.at(4)));
  } else if (what == "task") {
    const std::size_t n = words.size();
    const std::vector<std::string> rest(words.begin(), words.end() - 4);
    print(run_campaign_task(request_of(rest), std::stoull(words.at(n - 3)), std::stoull(words.at(n - 1))));
  } else if (what == "submit") {
    submit(words);
  } else if (what == "collect") {
    print(collect_campaign(request_of(words)));
#ifdef GONOGO_WITH_MPI
  } else if (what == "mpi") {
    run_with_mpi(words);
#endif
  } else {
    print(run_campaign(request_of(words)));
  }
  return 0;
}

int fail(ExitCode code, const std::exception& error) {
  std::fprintf(stderr, "campaign_program: %s\n", error.what());
  return int(code);
}

}  // namespace
}  // namespace gonogo::campaign

int main(int argc, char** argv) {
  using namespace gonogo;
  install_cancel_handler();
  try {
    return campaign::run(std::vector<std::string>(argv, argv + argc));
  } catch (const InputError& error) {
    return campaign::fail(ExitCode::bad_input, error);
  } catch (const Cancelled& error) {
    return campaign::fail(ExitCode::interrupted, error);
  } catch (const std::exception& error) {
    return campaign::fail(ExitCode::failure, error);
  }
}
