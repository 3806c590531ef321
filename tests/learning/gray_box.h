// Gray-box training on qubits (Benedetti et al., PRX 7, 041052 (2017)). The units of the data are chains of qubits. All
// programmed coefficients, also those inside chains, descend along the gradient of the machine's own rows:
//
//   h_i along g_i = <s_i>_data - <s_i>_rows,   J_ij along g_ij = <s_i s_j>_data - <s_i s_j>_rows
//
// A unit of k qubits responds to the sum of its k fields, which move together. Equal steps of all coefficients would be
// k-fold steps of the unit, and fields would oscillate at a rate that suits couplings. Steps are therefore those of
// Adam (Kingma & Ba 2015), whose size does not depend on the gradient's, divided among the coefficients that act
// together.
//
// Rows of data come from the same machine with the qubits of the visible units fixed. Training needs no temperature and
// compensates errors of the machine. The result is valid for this machine only.
#pragma once
#include <memory>

#include "learning/annealer/annealer_sampler.h"
#include "learning/model/weights.h"

namespace gonogo::learning {

struct GrayBoxSettings {
  double rate = 0.0015;          // step of the coupling of two units, as programmed; twice that for fields
  double first_coupling = 0.02;  // size of the initial couplings between chains
  double chain_coupling = 1;     // -J inside chains at the start
  std::size_t reads = 100;       // rows of the model per update
  std::size_t gauges = 2;        // of these reads
  std::size_t sweeps = 100;
  CoefficientRanges ranges;
  std::uint64_t seed = 1;
};

class GrayBox {
 public:
  GrayBox(std::shared_ptr<const Sampler> device, const HardwareGraph& graph, std::size_t visible, std::size_t hidden,
          const GrayBoxSettings& settings);
  /// One step. rows: [row x visible] of {0, 1}. share: factor of the rate.
  void update(std::span<const double> rows, double share = 1);
  const Problem& programmed() const { return problem_; }
  /// The machine over units, with unbroken chains, at inverse temperature `beta` of programmed energies.
  RbmWeights contracted(double beta) const;
  /// beta of the device's rows over units, by pseudo-likelihood of the machine over units.
  BetaEstimate measured_beta(std::size_t reads) const;

 private:
  struct Moments {
    std::vector<double> spin, pair;  // [qubit], [coupling]
  };
  /// Adam's running means of a coefficient's gradient and its square, and the coefficient's share of the unit's step.
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
