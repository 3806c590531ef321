// A campaign of cheap trials, as a program that tests can kill.
//   campaign_program run <folder> <points> <workers> <ms per trial> <behaviour> <places>
//   campaign_program worker <ms per trial> <behaviour> <places>
// Behaviours: "normal"; "crash:<index>" and "refuse:<index>" at that trial; "print" writes to standard output too.
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>

#include "base/cancel.h"
#include "base/error.h"
#include "pipeline/campaign/worker.h"
#include "tests/fault/cheap_campaign.h"
#include "tests/support/trials.h"

namespace gonogo::pipeline {
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
  if (places == 1) {
    run_worker([&](const DesignPoint& point) { return misbehave(point, milliseconds, behaviour); });
  } else {
    Shuffle trials(milliseconds, behaviour, std::size_t(places));
    run_worker(trials);
  }
}

int run(const std::vector<std::string>& words) {
  if (words.at(1) == "worker") {
    work(std::stoi(words.at(2)), words.at(3), std::stoi(words.at(4)));
    return 0;
  }
  CampaignRequest request = cheap_campaign(words.at(2), std::stoi(words.at(3)));
  request.workers = std::stoi(words.at(4));
  request.places = std::stoi(words.at(7));
  request.worker_command = {"/proc/self/exe", "worker", words.at(5), words.at(6), words.at(7)};
  const CampaignSummary summary = run_campaign(request);
  std::printf("trials %zu computed %zu reused %zu damaged %zu\n", summary.trials, summary.computed, summary.reused,
              summary.damaged);
  return 0;
}

int fail(ExitCode code, const std::exception& error) {
  std::fprintf(stderr, "campaign_program: %s\n", error.what());
  return int(code);
}

}  // namespace
}  // namespace gonogo::pipeline

int main(int argc, char** argv) {
  using namespace gonogo;
  install_cancel_handler();
  try {
    return pipeline::run(std::vector<std::string>(argv, argv + argc));
  } catch (const InputError& error) {
    return pipeline::fail(ExitCode::bad_input, error);
  } catch (const Cancelled& error) {
    return pipeline::fail(ExitCode::interrupted, error);
  } catch (const std::exception& error) {
    return pipeline::fail(ExitCode::failure, error);
  }
}
