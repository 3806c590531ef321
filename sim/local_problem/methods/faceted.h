// A LocalProblem with each friction disc replaced by the regular polygon inscribed in it, as linear complementarity
// problems.
//
// Directions d_j, j = 1 .. facets, are spread evenly over a disc (+1 and -1 in the plane). With r_t = sum_j d_j beta_j:
//
//   0 <= r_n     orthogonal to  u_n - sum_d c_d lambda_d       >= 0   (the sum for `ccp` alone)
//   0 <= beta_j  orthogonal to  d_j . u_d + lambda_d           >= 0
//   0 <= lambda  orthogonal to  c_d r_n - sum_j beta_j         >= 0
//
// `coulomb` is the form of Stewart & Trinkle (1996) and Anitescu & Potra (1997); `ccp` is the cone program over the
// polyhedral cone (Anitescu 2006), which the generators (1, c d_j) turn into a program with bounds alone:
//
//   0 <= gamma_j  orthogonal to  g_j . (W G gamma + q + s) >= 0
//
// There `coulomb` needs the fixed point s_n = sum_d c_d lambda_d (Cadoux 2009).
#pragma once
#include "sim/local_problem/algebra/lcp.h"
#include "sim/local_problem/algebra/scaled_problem.h"
#include "sim/state/iteration.h"

namespace gonogo::sim {

class FacetedProblem {
 public:
  /// facets: even, 4 .. 256.
  FacetedProblem(const LocalProblem& problem, Target target, int facets);

  /// Unknowns r_n, beta, lambda of contact after contact.
  Lcp multiplier_form() const;
  Eigen::VectorXd impulses_of_multipliers(const Eigen::VectorXd& x) const { return rays_ * x; }

  /// Unknowns gamma, with s = 0.
  Lcp generator_form() const;
  Eigen::VectorXd impulses_of_generators(const Eigen::VectorXd& gamma) const { return generators_ * gamma; }
  /// G^T s for s_n = sum_d c_d lambda_d at the scaled impulses r; 0 for `ccp`.
  Eigen::VectorXd slip_shift(const Eigen::VectorXd& r) const;
  /// Unknowns of the multiplier form for scaled impulses r = G gamma, with lambda as the velocities ask for.
  Eigen::VectorXd multipliers_of(const Eigen::VectorXd& gamma) const;

  Eigen::Index multiplier_count() const { return rays_.cols(); }
  Eigen::Index generator_count() const { return generators_.cols(); }
  bool is_symmetric() const;
  const ScaledProblem& scaled() const { return of_; }

 private:
  struct Polygon {
    Eigen::Index normal = 0;           // row of r_n
    Eigen::Index x_normal = 0, x = 0;  // unknowns of r_n and of the first beta
    Eigen::Index lambda = 0;
    int first = 0, size = 0;  // rows of the disc within the contact
    double c = 0;
  };

  int directions(const Polygon& polygon) const { return polygon.size == 1 ? 2 : facets_; }
  /// d_j of the polygon, in the rows of its disc.
  Eigen::Vector2d direction(const Polygon& polygon, int j) const;
  void lay_out();
  void make_generators();
  /// max_j -d_j . u_d: what lambda is at a solution, and 0 for u_d = 0.
  double facet_speed(const Polygon& polygon, const Eigen::VectorXd& u) const;

  const LocalProblem& p_;
  Target target_;
  int facets_;
  ScaledProblem of_;
  std::vector<Polygon> polygons_;
  std::vector<Eigen::Index> x_normal_;      // unknown of r_n of each contact
  Eigen::SparseMatrix<double> rays_;        // r of x
  Eigen::SparseMatrix<double> generators_;  // G
  Eigen::SparseMatrix<double> split_;       // x without lambda, of gamma
};

}  // namespace gonogo::sim
