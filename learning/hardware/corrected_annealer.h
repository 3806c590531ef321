// An annealer whose known distortions are divided out of the rows of any problem that is embedded on it.
//
// Rows of a device follow exp(-beta E') with a beta that nobody states and an E' that is not quite the programmed E.
// For every request this sampler measures and sets
//
//   chain strength  the weakest of three with at most 2 % of broken chains
//   scale           the one at which the pseudo-likelihood of the rows finds beta = 1 (temperature.h)
//   gauges          random ones, each a programming of its own, so that constant and random errors average out
//   leakage         fields are programmed with the first-order leak of the susceptibility taken off
//
// Rows may then go through a few sweeps of block Gibbs at beta = 1 on the host, as D-Wave's own post-processing
// ("sampling") did on the 2X. They take out what random errors of the programmings leave.
//
// What is left is in the answer's info: the beta of the rows with its interval, broken chains, coefficients cut to the
// range, masked pairs. Not divided out: that whole rows freeze hotter than single spins (docs/annealer.md), and the
// second order of random errors.
#pragma once
#include <memory>

#include "learning/hardware/annealer_sampler.h"

namespace gonogo::learning {

struct CorrectionSettings {
  double first_scale = 0.2;   // of the search: what a device of temperature 0.2 needs if nothing else warms its rows
  double susceptibility = 0;  // of the device, as published
  std::size_t programmings = 20;
  std::size_t probe_reads = 500;  // of every measurement
  std::size_t post_sweeps = 0;    // of block Gibbs on the host, from the device's rows; for bipartite problems
  CoefficientRanges ranges;
};

class CorrectedAnnealer final : public Sampler {
 public:
  /// `device` samples problems on qubits of `graph`. `embedding` lays the variables of every problem on them.
  CorrectedAnnealer(std::shared_ptr<const Sampler> device, const HardwareGraph& graph, Embedding embedding,
                    const CorrectionSettings& settings);
  std::string name() const override { return device_->name(); }
  /// info: scale, chain_coupling, beta, beta_low, beta_high, chain_break_fraction, cut_coefficients, masked_pairs,
  /// programmings, post_sweeps. beta is that of the device's rows.
  SampleSet sample(const Problem& problem, const SampleRequest& request) const override;

 private:
  AnnealerSampler tuned(const Problem& problem, const SampleRequest& request, double chain_coupling) const;
  std::shared_ptr<const Sampler> device_;
  HardwareGraph graph_;
  Embedding embedding_;
  CorrectionSettings settings_;
};

}  // namespace gonogo::learning
