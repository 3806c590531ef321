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
// Rows are not exchanged; tiny pivots are lifted (banded_matrix.h). The bits depend on `partitions`, not on threads.
#pragma once
#include <Eigen/Dense>
#include <vector>

#include "sim/local_problem/banded/banded_matrix.h"

namespace gonogo::sim {

enum class SpikeKind { full, truncated };

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

  Spike(const BandedMatrix<double>& a, const SpikeSettings& settings);

  /// A x = b in place (approximately when truncated). b: [size].
  void solve(Vector& b) const;

  int partitions() const { return int(part_.size()); }
  int boosted() const { return boosted_; }  // pivots that were lifted
  std::size_t bytes() const;                // of factors and tips

 private:
  struct Part {
    Eigen::Index first = 0, size = 0;
    BandedMatrix<Scalar> lu;
    Dense b, c;                              // coupling to the next and to the previous partition
    Dense v_top, v_bottom, w_top, w_bottom;  // [half x half]
    int boosted = 0;
  };
  /// Unknowns (bottom of p, top of p + 1), with those of p - 1 eliminated.
  struct Joint {
    Eigen::PartialPivLU<Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>> lu;
    Dense next;  // lu^-1 of the coupling to the top of p + 2: [2 half x half]
  };

  void factorise(const BandedMatrix<double>& a, Part& part, SpikeKind kind, Scalar least) const;
  void find_tips(const BandedMatrix<Scalar>& block, Part& part, SpikeKind kind, Scalar least) const;
  void join();
  void solve_joints(const Vector& g, Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>& y) const;

  Eigen::Index half_ = 0;
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
