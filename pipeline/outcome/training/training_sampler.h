// The sampler for the negative phase of training, as the settings choose it. It runs on a GPU if that is faster. A
// sampler that may fail has a stand-in.
//
// An emulated annealer shows the effect of hardware on a study's training before anyone pays for it. Dead qubits leave
// some pairs of units without a coupler: these pairs are masked, and their weights stay 0.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "learning/annealer/annealer_sampler.h"
#include "learning/rbm/train.h"
#include "learning/sampler/sampler.h"
#include "pipeline/outcome/settings.h"

namespace gonogo::outcome {

/// How an emulated annealer held the machine, and what its thermometer read in the last training run.
struct AnnealerReport {
  EmulatorChoice choice;
  std::size_t working_qubits = 0, longest_chain = 0;
  std::size_t pairs = 0, masked_pairs = 0;  // of a visible and a hidden unit
  double last_scale = 0;
  std::vector<learning::ThermometerReading> readings;
};

/// Who drew the rows of a training run.
struct SamplerReport {
  std::string name;
  bool on_gpu = false, stood_in = false;
  std::string wanted{}, reason{};  // of a stand-in: what it stood in for, and why
  std::optional<AnnealerReport> annealer{};
};

class TrainingSampler {
 public:
  /// Also sets what the sampler needs in `training`: masked weights, and a report after every epoch. Throws InputError
  /// if an annealer's graph has too few lines of qubits for the units.
  TrainingSampler(const LearningSettings& settings, const learning::VisibleLayout& layout,
                  learning::TrainingSettings& training);
  const learning::Sampler& sampler() const { return *sampler_; }
  /// Hook for learning::train_rbm(), to be called after every epoch: measures the annealer's temperature and sets its
  /// scale. Empty if the sampler needs none.
  learning::EpochHook watch();
  /// To be called before every training run: resets the annealer's scale and readings.
  void begin();
  /// Whether a stand-in draws the rows by now.
  bool stood_in() const { return stand_in_ && stand_in_->stood_in(); }
  SamplerReport report() const;

 private:
  void use_emulator(const learning::VisibleLayout& layout, learning::TrainingSettings& training);
  void use_with_stand_in(std::unique_ptr<learning::Sampler> wanted, const std::string& other);

  std::string wanted_;
  bool on_gpu_ = false;
  EmulatorChoice choice_;
  std::unique_ptr<learning::Sampler> sampler_;
  learning::WithStandIn* stand_in_ = nullptr;      // sampler_, if it is one
  learning::AnnealerSampler* annealer_ = nullptr;  // in sampler_, if it has one
  std::optional<learning::TemperatureControl> control_;
  std::vector<std::string> labels_;
  std::size_t working_qubits_ = 0, pairs_ = 0;
  std::uint64_t seed_ = 0;
};

}  // namespace gonogo::outcome
