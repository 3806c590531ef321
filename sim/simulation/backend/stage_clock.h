// Wall-clock times of stages.
#pragma once
#include <chrono>

#include "sim/simulation/stages.h"

namespace gonogo::sim {

/// `Wait` returns when the device has finished all queued work.
template <class Wait>
class StageClock {
 public:
  StageClock(StageTimes& times, Wait wait) : times_(times), wait_(std::move(wait)) { wait_(); }

  template <class Work>
  void operator()(Stage stage, const Work& work) const {
    const auto start = std::chrono::steady_clock::now();
    work();
    wait_();
    times_.seconds[int(stage)] += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }

 private:
  StageTimes& times_;
  Wait wait_;
};

}  // namespace gonogo::sim
