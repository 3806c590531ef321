#include "sim/elastic/tyre/tyre.h"

#include <Eigen/Eigenvalues>
#include <cmath>

#include "base/error.h"
#include "base/format.h"
#include "sim/elastic/tyre/press.h"
#include "sim/elastic/tyre/ring.h"

namespace gonogo::sim::elastic {
namespace {

void need_positive(double value, const char* name, const char* unit) {
  if (!(value > 0) || !std::isfinite(value))
    throw InputError(line("tyre: %s is %g%s; it must be above 0", name, value, unit));
}

void need_not_negative(double value, const char* name, const char* unit) {
  if (!(value >= 0) || !std::isfinite(value))
    throw InputError(line("tyre: %s is %g%s; it must be 0 or above", name, value, unit));
}

}  // namespace

void check_tyre(const Tyre& t) {
  need_positive(t.radius, "radius", " m");
  need_positive(t.width, "width", " m");
  need_positive(t.bending, "bending stiffness of the belt", " N m^2");
  need_positive(t.stretching, "tensile stiffness of the belt", " N");
  need_not_negative(t.tread, "thickness of the tread", " m");
  need_not_negative(t.pressure, "pressure", " Pa");
  need_not_negative(t.radial, "radial stiffness of the sidewalls", " N/m^2");
  need_not_negative(t.tangential, "tangential stiffness of the sidewalls", " N/m^2");
  need_not_negative(t.belt_mass, "mass of the belt", " kg");
  if (!(t.rim_radius > 0 && t.rim_radius < t.belt_radius()))
    throw InputError(line("tyre: the rim's radius is %g m; it must lie between 0 and the belt's radius, %g m",
                          t.rim_radius, t.belt_radius()));
  const double chord = t.belt_radius() - t.rim_radius;
  if (!(t.bulge >= 0 && t.bulge <= chord / 2))
    throw InputError(
        line("tyre: the sidewall's bulge is %g m; allowed is 0 to half its height, %g m", t.bulge, chord / 2));
  if (!(t.loss >= 0 && t.loss <= 0.3))
    throw InputError(line("tyre: the loss factor is %g; allowed is 0 to 0.3", t.loss));
  if (t.nodes < 24 || t.nodes > 10000)
    throw InputError(line("tyre: the ring has %d nodes; allowed are 24 to 10000", t.nodes));
  check_law(t.law, 2, "tread");
}

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
