// Progress of a training run in epochs over all its machines: those of the folds, then the last one. Before its epochs
// every machine gets a teacher, whose time is counted apart.
#pragma once
#include <chrono>

#include "base/progress.h"
#include "learning/rbm/train.h"

namespace gonogo::learn {

class TrainingProgress {
 public:
  /// `next` is called before each update; it may be empty.
  TrainingProgress(std::size_t folds, std::size_t epochs, learning::EpochHook next);
  /// Hook of learning::train_rbm() and of learning::cross_validate().
  learning::EpochHook watch();
  /// The machine in progress comes from an earlier run. Its epochs do not count in the rate.
  void reuse_machine() { reused_ += epochs_; }
  /// fit(), the teacher of the machine in progress on so many trials.
  template <class Fit>
  auto teach(std::size_t trials, const Fit& fit) {
    const auto start = std::chrono::steady_clock::now();
    begin_teacher(trials);
    auto teacher = fit();
    end_teacher(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    return teacher;
  }
  void machine_done(std::size_t done);
  /// The machine in progress is the last one and trains for `epochs`. It counts as much as a fold.
  void last_machine(std::size_t epochs) { last_epochs_ = epochs; }

 private:
  void update(std::size_t done);
  void begin_teacher(std::size_t trials);
  void end_teacher(double seconds);
  std::size_t folds_, epochs_;
  std::size_t machines_done_ = 0, last_epochs_, reused_ = 0;
  double teachers_ = 0, teaching_ = 0;  // teachers that this run fitted, and the time they took [s]
  learning::EpochHook next_;
  Progress progress_;
};

}  // namespace gonogo::learn
