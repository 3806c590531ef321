// A frictional contact problem in local form: unknown impulses r at nc contacts, in the contact frames (normal first).
//
//   u = W r + q,   u_n + mu |u_t| (+ mu_r |u_m|), u_t (, u_m)  in K*,  orthogonal to  r in K          (target coulomb)
//   u in K*,  orthogonal to  r in K                                                                    (target ccp)
//   K = { r_n >= 0, |r_t| <= mu r_n (, |r_m| <= mu_r r_n) },   K*: its dual cone
//
// W = H^T M^-1 H is the Delassus matrix; q the relative velocity without contact impulses. The units are the file's.
// Source of form and names: FCLib (Acary, Bremond, Koziara, Perignon, INRIA RT-0444, 2014), De Saxce & Feng 1998.
#pragma once
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "base/math/vec.h"
#include "sim/state/iteration.h"

namespace gonogo::sim {

/// Work of the linear systems inside a solver of contact problems.
struct LinearWork {
  long solves = 0, inner_iterations = 0;
  double setup_ms = 0, solve_ms = 0;       // ordering and factors; iterations
  std::size_t bytes = 0;                   // of the largest factors
  double multiply_adds = 0;                // of one factorisation; 0 where they are not counted
  std::ptrdiff_t half = 0, full_half = 0;  // half-bandwidth kept, and after reordering
  int partitions = 0;
  std::ptrdiff_t rank = 0;  // largest of a tensor train
  long builds = 0;          // of its inverse; fewer than Newton's matrices where one served several
  double dropped = 0;       // largest share of a matrix's Frobenius norm outside of the band
};

/// A part of the friction impulse with a bound of its own: |r[first .. first + size)| <= coefficient * r_n.
struct FrictionDisc {
  int first, size;
};

/// Square sparse matrix of dense blocks, row by row: blocks first[i] .. first[i + 1] - 1 belong to contact i, in
/// ascending order of column. Every row has its diagonal block.
struct BlockMatrix {
  std::vector<Index> first;   // [contact_count + 1]
  std::vector<Index> column;  // [block_count]
  std::vector<double> value;  // [block_count * dimension * dimension], each block row major
};

struct Triplet {
  Index row, column;
  double value;
};

struct LocalProblem {
  int dimension = 3;            // rows per contact: 2 (plane), 3, or 5 (rolling: normal, two tangents, two moments)
  BlockMatrix w;                // W [u / r]
  std::vector<double> q;        // [contact_count * dimension]
  std::vector<double> mu;       // sliding friction [contact_count]
  std::vector<double> mu_roll;  // rolling friction [contact_count]; empty unless dimension is 5
  std::string name;             // where it came from; starts every message about it

  Index contact_count() const { return Index(mu.size()); }
  int disc_count() const { return dimension == 5 ? 2 : 1; }
  FrictionDisc disc(int d) const { return {1 + 2 * d, dimension == 2 ? 1 : 2}; }
  double coefficient(Index contact, int d) const { return d == 0 ? mu[contact] : mu_roll[contact]; }
  const double* diagonal_block(Index contact) const {
    return w.value.data() + diagonal[contact] * dimension * dimension;
  }

  std::shared_ptr<const struct BodyForm> bodies;  // W = B B^T by bodies, where that is known
  bool is_whole = true;  // false: w holds the diagonal blocks alone, and products with W go by bodies

  std::vector<std::size_t> diagonal;  // block number of each contact's diagonal block [contact_count]
};

/// Assembles a problem from the entries of W (equal positions are summed) and checks it. Throws InputError, starting
/// with `name`, for a dimension other than 2, 3 or 5, lengths that disagree and positions outside the matrix. Refuses
/// values that are not finite, negative friction, and a contact whose W_nn is not positive.
LocalProblem make_problem(const std::string& name, int dimension, const std::vector<Triplet>& w, std::vector<double> q,
                          std::vector<double> mu, std::vector<double> mu_roll = {});

/// u = W r + q.
std::vector<double> velocity(const LocalProblem& problem, const std::vector<double>& r);

/// The rows of u = W r + q that belong to one contact, into u[dimension]. The problem is whole.
void contact_velocity(const LocalProblem& problem, const std::vector<double>& r, Index contact, double* u);

// A Delassus matrix by its factors: W = B B^T, B [rows x freedoms of bodies].

struct BodyForm {
  static constexpr int kFreedoms = 6;  // of a body: along x, y, z, about three axes; scaled so that their mass is 1

  struct Contact {
    Index body[2];                                        // -1: it cannot move
    std::array<std::array<double, kFreedoms>, 5> row[2];  // B: of the first `dimension` rows, for each body
  };

  Index body_count = 0;
  std::vector<Contact> contact;  // [contact_count]
};

/// y = B^T r, the bodies' motion under impulses r: [body_count * kFreedoms]. The problem has bodies.
std::vector<double> body_motion(const LocalProblem& problem, const std::vector<double>& r);

/// u = B B^T r + q.
std::vector<double> velocity_by_bodies(const LocalProblem& problem, const std::vector<double>& r);

/// Velocities at contacts while the impulses change contact by contact: by rows of W, or where the problem is not
/// whole by the bodies' motion, which costs the same for every contact however many others its bodies have.
class ContactVelocities {
 public:
  /// Keeps references to both.
  ContactVelocities(const LocalProblem& problem, const std::vector<double>& r);
  /// Rows of W r + q, into u[dimension].
  void at(Index contact, double* u) const;
  /// To be called after r of the contact has changed from `before`.
  void changed(Index contact, const double* before);

 private:
  const LocalProblem& problem_;
  const std::vector<double>& r_;
  std::vector<double> motion_;  // empty for a whole problem
};

// Error of impulses r as a solution of a LocalProblem; the measure of every solver here.

/// Nearest point of K, in the plain metric, for one contact: p[dimension] in and out.
///   min (n - p_n)^2 + sum_d (|t_d| - |p_d|)^2,  n >= 0, |t_d| <= c_d n
void project_onto_cone(const LocalProblem& problem, Index contact, double* p);

/// De Saxce's term sum_d c_d |u_d|: what `coulomb` adds to the normal velocity, so that u_n = 0 in sliding.
double de_saxce_term(const LocalProblem& problem, Index contact, const double* u);

/// | r - P_K(r - u^) | / max(|q|, |r|, |u|) with u = W r + q and u^ = u + de_saxce_term e_n for `coulomb`, u^ = u for
/// `ccp`; Euclidean norms over all contacts, as in fc3d_compute_error of Siconos. 0 when q, r and u are all 0.
double siconos_error(const LocalProblem& problem, const std::vector<double>& r, Target target = Target::coulomb);
/// With u = W r + q given.
double siconos_error(const LocalProblem& problem, const std::vector<double>& r, const std::vector<double>& u,
                     Target target);

}  // namespace gonogo::sim
