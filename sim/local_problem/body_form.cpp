#include "sim/local_problem/body_form.h"

#include <algorithm>

namespace gonogo::sim {
namespace {

constexpr int kFreedoms = BodyForm::kFreedoms;

/// motion += B^T dr for the rows of one contact. D: rows of a contact.
template <int D>
void push(const BodyForm::Contact& c, const double* dr, std::vector<double>& motion) {
  for (int k = 0; k < 2; ++k) {
    if (c.body[k] < 0) continue;
    double* const y = motion.data() + std::size_t(c.body[k]) * kFreedoms;
    for (int a = 0; a < D; ++a)
      for (int f = 0; f < kFreedoms; ++f) y[f] += c.row[k][a][f] * dr[a];
  }
}
void push(const LocalProblem& p, Index contact, const double* dr, std::vector<double>& motion) {
  const BodyForm::Contact& c = p.bodies->contact[std::size_t(contact)];
  p.dimension == 3 ? push<3>(c, dr, motion) : push<5>(c, dr, motion);
}

/// Rows of B motion + q of one contact.
template <int D>
void read(const BodyForm::Contact& c, const double* q, const std::vector<double>& motion, double* u) {
  std::copy_n(q, D, u);
  for (int k = 0; k < 2; ++k) {
    if (c.body[k] < 0) continue;
    const double* const y = motion.data() + std::size_t(c.body[k]) * kFreedoms;
    for (int a = 0; a < D; ++a)
      for (int f = 0; f < kFreedoms; ++f) u[a] += c.row[k][a][f] * y[f];
  }
}
void read(const LocalProblem& p, Index contact, const std::vector<double>& motion, double* u) {
  const BodyForm::Contact& c = p.bodies->contact[std::size_t(contact)];
  const double* const q = p.q.data() + std::size_t(contact) * p.dimension;
  p.dimension == 3 ? read<3>(c, q, motion, u) : read<5>(c, q, motion, u);
}

}  // namespace

std::vector<double> body_motion(const LocalProblem& problem, const std::vector<double>& r) {
  std::vector<double> motion(std::size_t(problem.bodies->body_count) * kFreedoms, 0.0);
  for (Index i = 0; i < problem.contact_count(); ++i)
    push(problem, i, r.data() + std::size_t(i) * problem.dimension, motion);
  return motion;
}

std::vector<double> velocity_by_bodies(const LocalProblem& problem, const std::vector<double>& r) {
  const std::vector<double> motion = body_motion(problem, r);
  std::vector<double> u(problem.q.size());
  for (Index i = 0; i < problem.contact_count(); ++i)
    read(problem, i, motion, u.data() + std::size_t(i) * problem.dimension);
  return u;
}

ContactVelocities::ContactVelocities(const LocalProblem& problem, const std::vector<double>& r)
    : problem_(problem), r_(r) {
  if (!problem.is_whole) motion_ = body_motion(problem, r);
}

void ContactVelocities::at(Index contact, double* u) const {
  problem_.is_whole ? contact_velocity(problem_, r_, contact, u) : read(problem_, contact, motion_, u);
}

void ContactVelocities::changed(Index contact, const double* before) {
  if (problem_.is_whole) return;
  double dr[5];
  for (int a = 0; a < problem_.dimension; ++a) dr[a] = r_[std::size_t(contact) * problem_.dimension + a] - before[a];
  push(problem_, contact, dr, motion_);
}

}  // namespace gonogo::sim
