#include "sim/elastic/tyre/modes.h"

#include <Eigen/Eigenvalues>

#include "base/error.h"
#include "sim/elastic/tyre/press.h"
#include "sim/elastic/tyre/ring.h"

namespace gonogo::sim::elastic {
namespace {

/// Tangent of the inflated tyre about a hub at the origin, and its places.
struct Inflated {
  Vector u;
  Eigen::SparseMatrix<double> tangent;
};

Inflated inflated(const Tyre& tyre, const Ring& ring) {
  Inflated found{ring.unloaded({}), Eigen::SparseMatrix<double>(ring.dofs(), ring.dofs())};
  if (tyre.pressure > 0) {
    const std::vector<double> state = PressedTyre(tyre, 0, {}).state();
    found.u = Eigen::Map<const Vector>(state.data(), long(state.size()));
  }
  Triplets triplets;
  ring.add_tangent(found.u, {}, 1, triplets);
  found.tangent.setFromTriplets(triplets.begin(), triplets.end());
  return found;
}

}  // namespace

SidewallStiffness sidewall_stiffness(const Tyre& tyre) {
  const Ring ring(tyre);
  const Inflated now = inflated(tyre, ring);
  Vector shift = Vector::Zero(ring.dofs()), turn = shift;
  for (int k = 0; k < ring.nodes(); ++k) {
    shift[3L * k] = 1;
    turn.segment<3>(3L * k) << -now.u[3L * k + 1], now.u[3L * k], 1;
  }
  return {shift.dot(now.tangent * shift), turn.dot(now.tangent * turn)};
}

std::vector<double> frequencies(const Tyre& tyre) {
  if (!(tyre.belt_mass > 0)) throw InputError("tyre: frequencies need the mass of the belt");
  const Ring ring(tyre);
  const Inflated now = inflated(tyre, ring);
  const auto [m, j] = ring.mass();
  Vector root(ring.dofs());
  for (int k = 0; k < ring.nodes(); ++k) root.segment<3>(3L * k) << std::sqrt(m), std::sqrt(m), std::sqrt(j);
  const Eigen::MatrixXd scaled =
      root.cwiseInverse().asDiagonal() * Eigen::MatrixXd(now.tangent) * root.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver((scaled + scaled.transpose()) / 2,
                                                              Eigen::EigenvaluesOnly);
  std::vector<double> f;
  for (const double square : solver.eigenvalues())
    f.push_back(std::sqrt(std::max(square, 0.0)) / (2 * std::numbers::pi));
  return f;
}

}  // namespace gonogo::sim::elastic
