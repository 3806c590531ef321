// Training through an emulated annealer: what hardware would do to a study's training, before it is paid for. Section
// "emulator" of "learning", read when the sampler is "emulator":
//
//   graph           "chimera:12" (default), "pegasus:16", "zephyr:12", ...     temperature  0.2, in units of h
//   dead_share      of the qubits (default 0.02)                               dead_seed    which ones
//   thermometer     "pseudo_likelihood" (default), "histogram", "offset_model" or "none": what sets the scale each
//   epoch chain_coupling  |J| inside chains (default 0.6)                            gauges       of every request
//   (default 4) sweeps          of the device's anneal (default 600)                       reads        of a reading
//   (default 250)
//
// Pairs of units that dead qubits leave without a coupler are masked: their weights stay 0, and the report counts them.
#pragma once
#include <memory>
#include <optional>

#include "base/json/config.h"
#include "learning/encoding/layout.h"
#include "learning/hardware/annealer_sampler.h"
#include "learning/hardware/emulator.h"
#include "learning/model/weights.h"
#include "learning/training_settings.h"

namespace gonogo::learn {

struct EmulatorChoice {
  std::string graph = "chimera:12";
  double temperature = 0.2, dead_share = 0.02;
  std::uint64_t dead_seed = 1;
  std::string thermometer = "pseudo_likelihood";
  double chain_coupling = 0.6;
  std::size_t gauges = 4, sweeps = 600, reads = 250;
};
EmulatorChoice read_emulator_choice(const std::optional<Config>& section);
Json to_json(const EmulatorChoice& choice);

class AnnealerTraining {
 public:
  /// Throws InputError when the graph has not enough lines for the units.
  AnnealerTraining(const EmulatorChoice& choice, const learning::VisibleLayout& layout, std::size_t hidden,
                   std::uint64_t seed);
  const learning::Sampler& sampler() const { return *sampler_; }
  /// Pairs of (visible unit, hidden unit) without a coupler.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> masked() const;
  /// Before every run of training: scale and readings as at first.
  void begin();
  /// After every epoch: measures the temperature and sets the scale.
  void watch(std::size_t epoch, const learning::RbmWeights& weights);
  /// What the machine was, what was masked, and the readings of the last run.
  Json report() const;

 private:
  EmulatorChoice choice_;
  std::vector<std::string> labels_;
  std::size_t visible_, hidden_, qubits_ = 0;
  std::uint64_t seed_;
  std::unique_ptr<learning::AnnealerSampler> sampler_;
  std::optional<learning::TemperatureControl> control_;
};

}  // namespace gonogo::learn
