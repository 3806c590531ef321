#include "pipeline/learn/training/training_progress.h"

#include <algorithm>

namespace gonogo::learn {

TrainingProgress::TrainingProgress(std::size_t folds, std::size_t epochs, learning::EpochHook next)
    : folds_(folds),
      epochs_(epochs),
      last_epochs_(epochs),
      next_(std::move(next)),
      progress_("train", "epochs", (folds + 1) * epochs) {}

learning::EpochHook TrainingProgress::watch() {
  return [this](std::size_t epoch, const learning::RbmWeights& weights) {
    const bool go_on = !next_ || next_(epoch, weights);
    update(machines_done_ * epochs_ + epoch * epochs_ / last_epochs_);
    return go_on;
  };
}

void TrainingProgress::machine_done(std::size_t done) {
  machines_done_ = done;
  update(done * epochs_);
}

void TrainingProgress::begin_teacher(std::size_t trials) {
  constexpr std::size_t kSlow = 1000;  // trials whose Gaussian process takes more than a second or two
  if (trials >= kSlow)
    progress_.announce("machine " + std::to_string(machines_done_ + 1) + " of " + std::to_string(folds_ + 1) +
                       ": its teacher learns " + std::to_string(trials) + " trials");
}

void TrainingProgress::end_teacher(double seconds) {
  constexpr double kKept = 0.01;  // [s] a kept teacher is read faster
  teachers_ += seconds > kKept;
  teaching_ += seconds;
  const double each = teachers_ > 0 ? teaching_ / teachers_ : 0;
  progress_.count_other_work(teaching_, each * double(folds_ - std::min(machines_done_, folds_)));
}

void TrainingProgress::update(std::size_t done) {
  const std::size_t machine = std::min(done / epochs_, folds_) + 1;
  progress_.update(done, "machine " + std::to_string(machine) + " of " + std::to_string(folds_ + 1), reused_);
}

}  // namespace gonogo::learn
