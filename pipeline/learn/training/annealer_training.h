// Training with an emulated annealer. It shows the effect of hardware on a study's training before anyone pays for it.
// The section "emulator" of "learning" is read if the sampler is "emulator":
//
//   graph           "chimera:12" (default), "pegasus:16", "zephyr:12", ...
//   temperature     of the device, in units of the fields h (default 0.2)
//   dead_share      share of dead qubits (default 0.02)
//   dead_seed       seed that draws the dead qubits
//   thermometer     what sets the scale after each epoch: "pseudo_likelihood" (default), "histogram", "offset_model" or
//                   "none"
//   chain_coupling  |J| inside chains (default 0.6)
//   gauges          of every request (default 4)
//   sweeps          of the device's anneal (default 600)
//   reads           of a temperature reading (default 250)
//
// Dead qubits leave some pairs of units without a coupler. These pairs are masked: their weights stay 0, and the report
// counts them.
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
/// Reads the section; without one the defaults hold. Throws InputError for unknown keys and values out of range.
EmulatorChoice read_emulator_choice(const std::optional<Config>& section);
Json to_json(const EmulatorChoice& choice);

class AnnealerTraining {
 public:
  /// Embeds the machine on the graph. Throws InputError if the graph has too few lines of qubits for the units.
  AnnealerTraining(const EmulatorChoice& choice, const learning::VisibleLayout& layout, std::size_t hidden,
                   std::uint64_t seed);
  const learning::Sampler& sampler() const { return *sampler_; }
  /// Pairs (visible unit, hidden unit) without a coupler.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> masked() const;
  /// To be called before every training run: resets scale and readings.
  void begin();
  /// To be called after every epoch: measures the temperature and sets the scale.
  void watch(std::size_t epoch, const learning::RbmWeights& weights);
  /// Settings, qubits, masked pairs, and the temperature readings of the last run.
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
