// Banded systems by partitions: SPIKE (Polizzi & Sameh 2006), as SaP::GPU uses it (Li, Serban & Negrut 2017).
//
//   A_0 B_0               The rows of partition p:  C_p x_(p-1) + A_p x_p + B_p x_(p+1) = f_p, where C_p and B_p touch
//   C_1 A_1 B_1           the last `half` unknowns of p - 1 and the first `half` of p + 1 only. Multiplied by A_p^-1:
//       C_2 A_2 ...         x_p + W_p x_(p-1)^bottom + V_p x_(p+1)^top = g_p,  the spikes V_p = A_p^-1 B_p, W_p
//       likewise
//
// Tops and bottoms of all partitions form a system of their own.
//   full       with all four tips of the spikes: block tridiagonal, exact
//   truncated  without V^top and W^bottom, which decay with the length of a diagonally dominant partition: blocks of
//              2 half for themselves, to be refined or used as a preconditioner
//
// The reduced system of the first partition needs the bottom of V alone, that of the last one the top of W. So the last
// one is factored from its last row up, and both give their tips from a corner of their factors: two partitions cost no
// more than one. Partitions between them cost three times their share, for the spikes.
//
// Rows are not exchanged; tiny pivots are lifted (band_factors.h). The bits depend on `partitions`, not on threads.
#pragma once
#include <Eigen/Dense>
#include <vector>

#include "sim/local_problem/banded/band_factors.h"
#include "sim/local_problem/banded/team_spike.h"

namespace gonogo::sim {

struct SpikeSettings {
  int partitions = 8;  // at most; a partition holds 2 half rows or more
  SpikeKind kind = SpikeKind::full;
};

/// Factors in `Scalar`, float or double, of a matrix in double.
template <class Scalar>
class Spike {
 public:
  using Vector = Eigen::Matrix<Scalar, Eigen::Dynamic, 1>;
  using Dense = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  /// Factors in double take the matrix's own storage.
  Spike(BandedMatrix<double> a, const SpikeSettings& settings);

  /// A x = b in place (approximately when truncated). b: [size].
  void solve(Vector& b) const;

  int partitions() const { return int(part_.size()); }
  int boosted() const { return boosted_; }  // pivots that were lifted
  std::size_t bytes() const;                // of factors and tips

 private:
  struct Part {
    Eigen::Index first = 0, size = 0;
    Dense b, c;                              // coupling to the next and to the previous partition
    Dense v_top, v_bottom, w_top, w_bottom;  // [half x half]
    int boosted = 0;
  };
  /// Unknowns (bottom of p, top of p + 1), with those of p - 1 eliminated.
  struct Joint {
    Eigen::PartialPivLU<Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>> lu;
    Dense next;  // lu^-1 of the coupling to the top of p + 2: [2 half x half]
  };

  using Columns = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;

  bool is_first(const Part& part) const { return part.first == 0; }
  bool is_last(const Part& part) const { return part.first > 0 && part.first + part.size == band_.size; }
  auto down(const Part& p) const { return walk_down(band_.row(p.first), p.size, half_); }
  auto up(const Part& p) const { return walk_up(band_.row(p.first), p.size, half_); }

  void take_coupling(Part& part);
  void factorise(Part& part, Scalar least);
  void find_spikes(Part& part) const;
  void join();
  void begin(const Part& part, Scalar* x, Vector& tips) const;
  void finish(const Part& part, const Vector& at_top, const Vector& at_bottom, Scalar* x) const;
  Columns solve_joints(const Columns& tips) const;

  Eigen::Index half_ = 0;
  BandedMatrix<Scalar> band_;  // factors, part by part
  SpikeKind kind_;
  std::vector<Part> part_;
  std::vector<Joint> joint_;
  int boosted_ = 0;
};

/// x with |b - A x| <= tolerance |b|, by iterative refinement in double of solutions by `spike`. iterations: solutions
/// taken; the best x after `max` or where the residual no longer halves.
struct Refined {
  Eigen::VectorXd x;
  double residual = 0;  // |b - A x| / |b|
  int iterations = 0;
};
template <class Scalar>
Refined refine(const BandedMatrix<double>& a, const Spike<Scalar>& spike, const Eigen::VectorXd& b, double tolerance,
               int max = 50);

}  // namespace gonogo::sim
