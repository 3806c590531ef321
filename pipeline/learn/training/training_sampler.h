// Where the negative phase of a study's training comes from: the sampler that its settings name, on a GPU where that
// gains, with a stand-in where it may be out of reach, or an emulated annealer whose scale follows its temperature.
#pragma once
#include <memory>

#include "learning/rbm/train.h"
#include "pipeline/learn/training/annealer_training.h"
#include "pipeline/learn/training/settings.h"

namespace gonogo::learn {

class TrainingSampler {
 public:
  /// Takes what the sampler asks for into `training`: masked weights, a look at every epoch.
  TrainingSampler(const LearningSettings& settings, const learning::VisibleLayout& layout,
                  learning::TrainingSettings& training);
  const learning::Sampler& sampler() const { return annealer_ ? annealer_->sampler() : *sampler_; }
  /// To be called with every machine of a run, and between runs.
  learning::EpochHook watch();
  void begin();
  /// Which sampler the rows came from in the end, why not from the one that was asked for, and what an annealer was.
  void report(Json& report) const;

 private:
  std::string wanted_;
  bool on_gpu_ = false;
  std::unique_ptr<learning::Sampler> sampler_;
  std::unique_ptr<AnnealerTraining> annealer_;
};

}  // namespace gonogo::learn
