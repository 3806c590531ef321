// Training on the qubits themselves (Benedetti et al., PRX 7, 041052 (2017)): the units of the data stand on chains of
// qubits, and all programmed coefficients, those inside chains too, follow the gradient of the machine's own rows,
//
//   g_i = <s_i>_data - <s_i>_rows   down which h_i goes,   g_ij = <s_i s_j>_data - <s_i s_j>_rows   down which J_ij.
//
// A unit of k qubits answers to the sum of its k fields, which move together; equal steps for all coefficients are
// k-fold steps for the unit, and steps that suit a coupling throw a field to and fro. So steps are those of Adam
// (Kingma & Ba 2015), whose size does not depend on the size of a gradient, divided among the coefficients that act
// together.
//
// Rows of data come from the same machine with the qubits of the visible units fixed. No temperature is needed, and
// errors of the machine are learned around; what is learned belongs to this machine.
#pragma once
#include <memory>

#include "learning/hardware/annealer_sampler.h"
#include "learning/model/weights.h"

namespace gonogo::learning {

struct GrayBoxSettings {
  double rate = 0.0015;          // size of a step of the coupling of two units, in programmed units; fields: twice
  double first_coupling = 0.02;  // size of the first couplings between chains
  double chain_coupling = 1;     // -J inside chains at the start
  std::size_t reads = 100;       // of the model's rows at each update
  std::size_t gauges = 2;        // of them
  std::size_t sweeps = 100;
  CoefficientRanges ranges;
  std::uint64_t seed = 1;
};

class GrayBox {
 public:
  GrayBox(std::shared_ptr<const Sampler> device, const HardwareGraph& graph, std::size_t visible, std::size_t hidden,
          const GrayBoxSettings& settings);
  /// One step; rows: [row x visible] of {0, 1}. share: of the rate.
  void update(std::span<const double> rows, double share = 1);
  const Problem& programmed() const { return problem_; }
  /// The machine over units that the chains make when they hold, at inverse temperature `beta` of programmed energies.
  RbmWeights contracted(double beta) const;
  /// beta of the device's rows over units, by pseudo-likelihood of the contracted machine.
  BetaEstimate measured_beta(std::size_t reads) const;

 private:
  struct Moments {
    std::vector<double> spin, pair;  // [qubit], [coupling]
  };
  /// Adam's running means of a coefficient's gradient and its square, and what part of a unit's step it takes.
  struct Descent {
    double mean = 0, square = 0, part = 1;
  };
  Moments model_moments() const;
  Moments data_moments(std::span<const double> rows) const;
  SampleSet device_rows(const Problem& problem, std::size_t reads, std::size_t gauges, std::uint64_t draw) const;
  Problem contracted_problem() const;
  void share_steps();
  double step(Descent& descent, double gradient) const;

  std::shared_ptr<const Sampler> device_;
  GrayBoxSettings settings_;
  std::size_t visible_, hidden_;
  Problem problem_;                      // over qubits, SPIN
  std::vector<std::uint32_t> variable_;  // [qubit] the unit whose chain it belongs to
  EmbeddingRecord record_;
  std::vector<Descent> field_, coupling_;  // [qubit], [coupling]
  std::uint64_t updates_ = 0;
  mutable std::uint64_t draws_ = 0;
};

}  // namespace gonogo::learning
