// A machine on qubits as a sampler of bipartite problems: embedding, gauges, scale, unembedding; and what keeps its
// scale such that rows follow exp(-E).
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "learning/hardware/temperature.h"
#include "learning/hardware/unembed.h"
#include "learning/sampler/sampler.h"

namespace gonogo::learning {

struct AnnealerSettings {
  double scale = 1;           // programmed = scale times the problem's Ising coefficients
  double chain_coupling = 1;  // |J| inside chains as programmed
  std::size_t gauges = 4;     // reads are spread over so many random gauges, which turns constant errors into noise
  std::size_t sweeps = 0;     // of the device; 0: those of the request
  BrokenChains broken = BrokenChains::weighted_random;
  CoefficientRanges ranges;
};

class AnnealerSampler final : public Sampler {
 public:
  /// For problems of `visible` + `hidden` variables, embedded once as a biclique. `device` takes problems on qubits.
  AnnealerSampler(std::shared_ptr<const Sampler> device, const HardwareGraph& graph, std::size_t visible,
                  std::size_t hidden, const AnnealerSettings& settings);
  std::string name() const override { return device_->name(); }
  /// A coefficient that the scale would take out of range is cut to the range's end, as info.cut_coefficients says.
  SampleSet sample(const Problem& problem, const SampleRequest& request) const override;

  /// The largest scale at which every coefficient is in range and no coupling exceeds half of those inside chains, so
  /// that chains still decide.
  double largest_scale(const Problem& problem) const;
  double scale() const { return settings_.scale; }
  void set_scale(double scale) { settings_.scale = scale; }
  const Embedding& embedding() const { return embedding_; }

 private:
  std::shared_ptr<const Sampler> device_;
  HardwareGraph graph_;
  Embedding embedding_;
  std::size_t variables_;
  AnnealerSettings settings_;
};

enum class Thermometer {
  none,               // the scale stays as it is set
  pseudo_likelihood,  // local: every spin given the others
  histogram,          // global: energies at two scales
  offset_model        // pseudo-likelihood at two scales each epoch, T = offset + slope / scale over all of them
};
Thermometer thermometer_named(const std::string& name);

/// One line of the log.
struct ThermometerReading {
  std::size_t epoch = 0;
  double scale = 0, beta = 0, low = 0, high = 0;  // beta of rows at this scale, before the scale was set anew
};

/// Sets the sampler's scale once per epoch so that rows have beta = 1, within its largest scale and a factor of four
/// around the first one: where broken chains make rows hotter as the scale grows, no scale may be right.
class TemperatureControl {
 public:
  TemperatureControl(AnnealerSampler& sampler, Thermometer thermometer, std::size_t reads, std::size_t sweeps,
                     std::uint64_t seed)
      : sampler_(sampler),
        thermometer_(thermometer),
        reads_(reads),
        sweeps_(sweeps),
        seed_(seed),
        first_scale_(sampler.scale()) {}
  void update(std::size_t epoch, const Problem& problem);
  const std::vector<ThermometerReading>& log() const { return log_; }

 private:
  SampleSet rows_at(double scale, const Problem& problem, std::uint64_t draw);
  AnnealerSampler& sampler_;
  Thermometer thermometer_;
  std::size_t reads_, sweeps_;
  std::uint64_t seed_;
  double first_scale_;
  std::vector<ThermometerReading> log_;
  std::vector<double> scales_, temperatures_, errors_;
};

}  // namespace gonogo::learning
