// An annealer as a sampler of problems: embedding, gauges, scale, unembedding. TemperatureControl adjusts the
// scale so that rows follow exp(-E).
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "learning/hardware/temperature.h"
#include "learning/hardware/unembed.h"
#include "learning/sampler/sampler.h"

namespace gonogo::learning {

struct AnnealerSettings {
  double scale = 1;           // programmed coefficients over the problem's Ising coefficients
  double chain_coupling = 1;  // |J| inside chains as programmed
  std::size_t gauges = 4;     // number of random gauges; they turn constant errors into noise
  std::size_t sweeps = 0;     // of the device; 0: as in the request
  BrokenChains broken = BrokenChains::weighted_random;
  CoefficientRanges ranges;
  double susceptibility =
      0;  // chi of the device: fields are programmed with the leak chi J h taken off, to first order
};

class AnnealerSampler final : public Sampler {
 public:
  /// For problems of `visible` + `hidden` variables, which are embedded once as a biclique. `device` samples problems
  /// on qubits.
  AnnealerSampler(std::shared_ptr<const Sampler> device, const HardwareGraph& graph, std::size_t visible,
                  std::size_t hidden, const AnnealerSettings& settings);
  /// With a given embedding, of any problem.
  AnnealerSampler(std::shared_ptr<const Sampler> device, const HardwareGraph& graph, Embedding embedding,
                  std::size_t variables, const AnnealerSettings& settings);
  std::string name() const override { return device_->name(); }
  /// Coefficients beyond the range are clipped to its ends; info.cut_coefficients counts them.
  SampleSet sample(const Problem& problem, const SampleRequest& request) const override;

  /// Largest scale with all coefficients in range and every coupling at most half of those inside chains, so that
  /// chains hold.
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
  none,               // the scale does not change
  pseudo_likelihood,  // local: each spin given the others
  histogram,          // global: energies at two scales
  offset_model        // pseudo-likelihood at two scales an epoch; T = offset + slope / scale is fitted to all epochs
};
Thermometer thermometer_named(const std::string& name);

/// An entry of the log.
struct ThermometerReading {
  std::size_t epoch = 0;
  double scale = 0, beta = 0, low = 0, high = 0;  // beta of rows at this scale, before the update
};

/// Sets the sampler's scale once an epoch so that rows have beta = 1. The scale stays below largest_scale() and within
/// a factor of four of the first one, because no scale may be right: broken chains heat rows as the scale grows.
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
