// A Delassus matrix by its factors: W = B B^T, B [rows x freedoms of bodies].
#pragma once
#include <array>
#include <vector>

#include "sim/local_problem/problem.h"

namespace gonogo::sim {

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

}  // namespace gonogo::sim
