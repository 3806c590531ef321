#include "pipeline/learn/training/training_sampler.h"

#include "learning/sampler/block_gibbs.h"
#include "learning/sampler/gpu_chains.h"
#include "learning/sampler/stand_in.h"

namespace gonogo::learn {
namespace {

/// Min number of unit updates per update of the weights for which a GPU is faster. Below it, launching takes longer.
constexpr double kGpuGains = 1e6;

bool gpu_gains(const LearningSettings& settings, std::size_t visible) {
  const learning::TrainingSettings& training = settings.training;
  const double updates = double(training.chains) * double(training.sweeps) * double(visible + training.hidden);
  return settings.sampler == "block_gibbs" && settings.gpu && updates >= kGpuGains && learning::gpu_answers();
}

std::unique_ptr<learning::Sampler> with_stand_in(std::unique_ptr<learning::Sampler> wanted, const std::string& other) {
  return std::make_unique<learning::WithStandIn>(std::move(wanted), learning::make_sampler(other));
}

}  // namespace

TrainingSampler::TrainingSampler(const LearningSettings& settings, const learning::VisibleLayout& layout,
                                 learning::TrainingSettings& training)
    : wanted_(settings.sampler), on_gpu_(gpu_gains(settings, layout.unit_count())) {
  if (wanted_ == "emulator") {
    annealer_ = std::make_unique<AnnealerTraining>(settings.emulator, layout, training.hidden, training.seed);
    training.masked = annealer_->masked();
    training.report_every = 1;  // the temperature is taken after every epoch
  } else if (wanted_ == "command") {
    learning::SamplerSettings outside;
    outside.command = settings.command;
    sampler_ = with_stand_in(learning::make_sampler("command", outside), settings.stand_in);
  } else {
    sampler_ = on_gpu_ ? with_stand_in(std::make_unique<learning::BlockGibbs>(true), "block_gibbs")
                       : learning::make_sampler(wanted_);
  }
}

learning::EpochHook TrainingSampler::watch() {
  if (!annealer_) return {};
  return [this](std::size_t epoch, const learning::RbmWeights& weights) {
    annealer_->watch(epoch, weights);
    return true;
  };
}

void TrainingSampler::begin() {
  if (annealer_) annealer_->begin();
}

bool TrainingSampler::stood_in() const {
  const auto* chosen = dynamic_cast<const learning::WithStandIn*>(&sampler());
  return chosen && chosen->stood_in();
}

void TrainingSampler::report(Json& report) const {
  const auto* chosen = dynamic_cast<const learning::WithStandIn*>(&sampler());
  const bool stood_in = this->stood_in();
  report["sampler"] = sampler().name();
  report["sampled_on"] = on_gpu_ && !stood_in ? "gpu" : "cpu";
  report["stand_in"] = stood_in;
  if (annealer_) report["annealer"] = annealer_->report();
  if (!stood_in) return;
  report["sampler_wanted"] = on_gpu_ ? wanted_ + " on a GPU" : wanted_;
  report["stand_in_reason"] = chosen->reason();
}

}  // namespace gonogo::learn
