// The sampler for the negative phase of training, as the settings choose it. It runs on a GPU if that is faster. A
// sampler that may fail has a stand-in. For an emulated annealer it also follows the temperature.
#pragma once
#include <memory>

#include "learning/rbm/train.h"
#include "pipeline/learn/training/annealer_training.h"
#include "pipeline/learn/training/settings.h"

namespace gonogo::learn {

class TrainingSampler {
 public:
  /// Also sets what the sampler needs in `training`: masked weights, and a report after every epoch.
  TrainingSampler(const LearningSettings& settings, const learning::VisibleLayout& layout,
                  learning::TrainingSettings& training);
  const learning::Sampler& sampler() const { return annealer_ ? annealer_->sampler() : *sampler_; }
  /// Hook for learning::train(), to be called after every epoch. Empty if the sampler needs none.
  learning::EpochHook watch();
  /// To be called before every training run.
  void begin();
  /// Whether a stand-in draws the rows by now.
  bool stood_in() const;
  /// Adds to `report`: the sampler that drew the rows, why a stand-in drew them, and the annealer's report.
  void report(Json& report) const;

 private:
  std::string wanted_;
  bool on_gpu_ = false;
  std::unique_ptr<learning::Sampler> sampler_;
  std::unique_ptr<AnnealerTraining> annealer_;
};

}  // namespace gonogo::learn
