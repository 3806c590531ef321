// Training on the qubits themselves (Benedetti et al., PRX 7, 041052 (2017)): the units of the data stand on chains of
// qubits, and all programmed coefficients, those inside chains too, follow the gradient of the machine's own rows,
//
//   h_i -> h_i - r (<s_i>_data - <s_i>_rows),   J_ij -> J_ij - r (<s_i s_j>_data - <s_i s_j>_rows).
//
// Rows of data come from the same machine with the qubits of the visible units fixed. No temperature is needed, and
// errors of the machine are learned around; what is learned belongs to this machine.
#pragma once
#include <memory>

#include "learning/hardware/annealer_sampler.h"
#include "learning/model/weights.h"

namespace gonogo::learning {

struct GrayBoxSettings {
  double rate = 0.02;            // r, in programmed units
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
  /// One step; rows: [row x visible] of {0, 1}.
  void update(std::span<const double> rows);
  const Problem& programmed() const { return problem_; }
  /// The machine over units that the chains make when they hold, at inverse temperature `beta` of programmed energies.
  RbmWeights contracted(double beta) const;
  /// beta of the device's rows over units, by pseudo-likelihood of the contracted machine.
  BetaEstimate measured_beta(std::size_t reads) const;

 private:
  struct Moments {
    std::vector<double> spin, pair;  // [qubit], [coupling]
  };
  Moments model_moments() const;
  Moments data_moments(std::span<const double> rows) const;
  SampleSet device_rows(const Problem& problem, std::size_t reads, std::size_t gauges, std::uint64_t draw) const;
  Problem contracted_problem() const;

  std::shared_ptr<const Sampler> device_;
  GrayBoxSettings settings_;
  std::size_t visible_, hidden_;
  Problem problem_;                      // over qubits, SPIN
  std::vector<std::uint32_t> variable_;  // [qubit] the unit whose chain it belongs to
  EmbeddingRecord record_;
  mutable std::uint64_t draws_ = 0;
};

}  // namespace gonogo::learning
