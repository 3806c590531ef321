// An annealer as a sampler of problems: embedding, gauges, scale, unembedding. TemperatureControl adjusts the scale
// from epoch to epoch of a training, CorrectedAnnealer for every request, so that rows follow exp(-E).
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "learning/annealer/temperature.h"
#include "learning/qubits/unembed.h"
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

/// What became of a request on the device.
struct AnnealerUse {
  double scale = 0;
  std::size_t cut_coefficients = 0;  // beyond the range: they are clipped to its ends
  double chain_break_fraction = 0;
};

class AnnealerSampler final : public Sampler {
 public:
  /// For problems of `visible` + `hidden` variables, which are embedded once as a biclique. `device` samples problems
  /// on qubits.
  AnnealerSampler(std::shared_ptr<const Sampler> device, const HardwareGraph& graph, std::size_t visible,
                  std::size_t hidden, const AnnealerSettings& settings);
  /// For any problem, with a given embedding.
  AnnealerSampler(std::shared_ptr<const Sampler> device, const HardwareGraph& graph, Embedding embedding,
                  std::size_t variables, const AnnealerSettings& settings);
  std::string name() const override { return device_->name(); }
  /// info: the fields of AnnealerUse.
  SampleSet sample(const Problem& problem, const SampleRequest& request) const override;
  SampleSet sample(const Problem& problem, const SampleRequest& request, AnnealerUse& use) const;

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

/// Rows of `source` after sweeps of block Gibbs at beta = 1 here, each from its row, as D-Wave's post-processing
/// ("sampling") did on the 2X. For bipartite problems.
class SweptOn final : public Sampler {
 public:
  SweptOn(std::unique_ptr<Sampler> source, std::size_t sweeps) : source_(std::move(source)), sweeps_(sweeps) {}
  std::string name() const override { return source_->name(); }
  SampleSet sample(const Problem& problem, const SampleRequest& request) const override;

 private:
  std::unique_ptr<Sampler> source_;
  std::size_t sweeps_;
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
/// a factor `furthest` of the first one, because no scale may be right: broken chains heat rows as the scale grows.
/// Rows that are all local minima tell no temperature, but that they are too cold.
class TemperatureControl {
 public:
  TemperatureControl(AnnealerSampler& sampler, Thermometer thermometer, std::size_t reads, std::size_t sweeps,
                     std::uint64_t seed, double furthest = 4)
      : sampler_(sampler),
        thermometer_(thermometer),
        reads_(reads),
        sweeps_(sweeps),
        seed_(seed),
        first_scale_(sampler.scale()),
        furthest_(furthest) {}
  void update(std::size_t epoch, const Problem& problem);
  const std::vector<ThermometerReading>& log() const { return log_; }

 private:
  SampleSet rows_at(double scale, const Problem& problem, std::uint64_t draw);
  AnnealerSampler& sampler_;
  Thermometer thermometer_;
  std::size_t reads_, sweeps_;
  std::uint64_t seed_;
  double first_scale_, furthest_;
  std::vector<ThermometerReading> log_;
  std::vector<double> scales_, temperatures_, errors_;
};

struct CorrectionSettings {
  /// Of the search: what a device of temperature 0.2 needs if nothing else warms its rows. The search goes up to a
  /// factor of 50 from it.
  double first_scale = 0.2;
  double susceptibility = 0;  // of the device, as published
  std::size_t programmings = 20;
  std::size_t probe_reads = 500;  // of every measurement
  std::size_t post_sweeps = 0;    // of block Gibbs on the host, from the device's rows; for bipartite problems
  CoefficientRanges ranges;
};

/// What a corrected annealer set for a request, and what it left.
struct Correction {
  AnnealerUse use;
  double chain_coupling = 0;
  double beta = 0, beta_low = 0, beta_high = 0;  // of the device's rows, with its interval
  std::size_t masked_pairs = 0, programmings = 0, post_sweeps = 0;
};
Json to_json(const Correction& correction);

/// An annealer whose known distortions are divided out of the rows of any problem that is embedded on it.
///
/// Rows of a device follow exp(-beta E') with a beta that nobody states and an E' that is not quite the programmed E.
/// For every request this sampler measures and sets
///
///   chain strength  the weakest of three with at most 2 % of broken chains: 0.6, 0.8 and 1 of the range, or of what is
///                   5 times the temperature if that is less than half of it
///   scale           the one at which the pseudo-likelihood of the rows finds beta = 1 (temperature.h)
///   gauges          random ones, each a programming of its own, so that constant and random errors average out
///   leakage         fields are programmed with the first-order leak of the susceptibility taken off
///
/// Rows may then go through a few sweeps of block Gibbs at beta = 1 on the host, as D-Wave's own post-processing
/// ("sampling") did on the 2X. They take out what random errors of the programmings leave.
///
/// What is left is in the Correction: the beta of the rows with its interval, broken chains, coefficients cut to the
/// range, masked pairs. Not divided out: that whole rows freeze hotter than single spins (docs/annealer.md), and the
/// second order of random errors.
class CorrectedAnnealer final : public Sampler {
 public:
  /// `device` samples problems on qubits of `graph`. `embedding` lays the variables of every problem on them.
  CorrectedAnnealer(std::shared_ptr<const Sampler> device, const HardwareGraph& graph, Embedding embedding,
                    const CorrectionSettings& settings);
  std::string name() const override { return device_->name(); }
  /// info: to_json() of the correction.
  SampleSet sample(const Problem& problem, const SampleRequest& request) const override;
  SampleSet sample(const Problem& problem, const SampleRequest& request, Correction& correction) const;

 private:
  AnnealerSampler tuned(const Problem& problem, const SampleRequest& request, double chain_coupling) const;
  std::shared_ptr<const Sampler> device_;
  HardwareGraph graph_;
  Embedding embedding_;
  CorrectionSettings settings_;
};

}  // namespace gonogo::learning
