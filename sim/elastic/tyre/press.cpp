#include "sim/elastic/tyre/press.h"

#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/format.h"
#include "base/progress.h"
#include "sim/elastic/tyre/ring.h"

namespace gonogo::sim::elastic {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

struct Balance {
  Vector force;          // [dofs] [N]
  double scale = 0;      // norm of the largest part [N]
  double round_off = 0;  // residual that places known to eps of themselves leave [N]
  RimLoad rim;
  std::vector<ContactPoint> points;
};

}  // namespace

struct PressedTyre::Parts {
  Ring ring;
  std::vector<RigidShape> ground;
  PressSettings settings;
  Rim rim;
  Vector u, pull;
  Balance now;
  std::string reason;
  int iterations = 0;

  Balance balance(const Vector& x, const Rim& at, Triplets* tangent) const;
  bool solve(const Rim& at, Vector x);
  bool solve_from(const Rim& to);
};

Balance PressedTyre::Parts::balance(const Vector& x, const Rim& at, Triplets* tangent) const {
  Balance b;
  RingShape shape;
  ring.measure(x, at, shape);
  b.force = Vector::Zero(ring.dofs());
  b.rim = ring.add_forces(x, shape, shape.strain, b.force);
  const Vector still = Vector::Zero(ring.dofs());
  Vector contact = still;
  ring.add_contact(x, {.ground = ground, .v = still}, contact, tangent, b.points);
  if (tangent != nullptr) ring.add_tangent(x, at, 1, *tangent);
  const Tyre& t = ring.tyre();
  const double air = t.pressure * t.width * ring.share() * std::sqrt(double(t.nodes));
  b.scale = std::max({air, contact.norm(), pull.norm(), 1e-12 * t.stretching});
  b.round_off = 4e-15 * t.stretching / ring.share() * x.norm();
  b.force += contact + pull;
  return b;
}

bool PressedTyre::Parts::solve(const Rim& at, Vector x) {
  for (int i = 0;; ++i) {
    stop_if_cancelled();
    Triplets tangent;
    Balance b = balance(x, at, &tangent);
    const double norm = b.force.norm();
    if (norm <= std::max(settings.tolerance * b.scale, b.round_off)) {
      u = std::move(x);
      rim = at;
      now = std::move(b);
      return true;
    }
    if (i == settings.max_iterations) {
      reason = line("Newton's method did not converge in %d iterations: residual %g of the forces", i, norm / b.scale);
      return false;
    }
    ++iterations;
    Sparse matrix(ring.dofs(), ring.dofs());
    matrix.setFromTriplets(tangent.begin(), tangent.end());
    Eigen::SparseLU<Sparse> lu(matrix);
    Vector dx;
    if (lu.info() == Eigen::Success) dx = lu.solve(b.force);
    if (dx.size() == 0 || !dx.allFinite()) {
      reason = "the tangent matrix is singular: the ring is held by nothing, or buckles";
      return false;
    }
    Vector best = x + dx;
    double least = balance(best, at, nullptr).force.norm();
    for (double share = 0.5; share > 1e-2 && !(least < norm); share /= 2) {
      Vector next = x + share * dx;
      const double met = balance(next, at, nullptr).force.norm();
      if (met < least || !std::isfinite(least)) {
        least = met;
        best = std::move(next);
      }
    }
    x = std::move(best);
  }
}

/// From the last balance, which goes along with the rim as a rigid body's tangent would.
bool PressedTyre::Parts::solve_from(const Rim& to) { return solve(to, u + ring.unloaded(to) - ring.unloaded(rim)); }

PressedTyre::PressedTyre(const Tyre& tyre, double height, std::vector<RigidShape> ground, const PressSettings& settings)
    : parts_(std::make_unique<Parts>(Parts{.ring = Ring(tyre),
                                           .ground = std::move(ground),
                                           .settings = settings,
                                           .rim = {.y = height},
                                           .u = {},
                                           .pull = {},
                                           .now = {},
                                           .reason = {}})) {
  Parts& p = *parts_;
  p.u = p.ring.unloaded(p.rim);
  p.pull = Vector::Zero(p.ring.dofs());
  if (!p.solve(p.rim, p.u)) throw InputError("tyre: it finds no balance when inflated: " + p.reason);
}

PressedTyre::~PressedTyre() = default;
PressedTyre::PressedTyre(PressedTyre&&) noexcept = default;

bool PressedTyre::move_rim(const Rim& to) {
  Parts& p = *parts_;
  const Rim from = p.rim;
  const double way = std::max(
      {std::fabs(to.x - from.x), std::fabs(to.y - from.y), std::fabs(to.turn - from.turn) * p.ring.tyre().radius});
  const int count = std::max(1, int(std::ceil(way / p.settings.increment)));
  for (int k = 1; k <= count; ++k) {
    const double s = double(k) / count;
    Rim at = to;
    at.x = from.x + s * (to.x - from.x);
    at.y = from.y + s * (to.y - from.y);
    at.turn = from.turn + s * (to.turn - from.turn);
    if (!p.solve_from(at)) return false;
  }
  return true;
}

bool PressedTyre::carry(double load) {
  if (!(load > 0)) throw InputError(line("tyre: the load is %g N; it must be above 0", load));
  Parts& p = *parts_;
  const auto at = [&](double y) {
    Rim r = p.rim;
    r.y = y;
    return move_rim(r);
  };
  double high = p.rim.y, high_load = contact_load();
  while (high_load > load) {
    if (!at(high + p.settings.increment)) return false;
    high = p.rim.y;
    high_load = contact_load();
  }
  double low = high, low_load = high_load;
  while (low_load < load) {
    high = low;
    high_load = low_load;
    if (!at(low - p.settings.increment)) return false;
    low = p.rim.y;
    low_load = contact_load();
  }
  for (int i = 0; i < 60 && std::fabs(contact_load() - load) > 1e-6 * load; ++i) {  // false position, kept inside
    const double share = std::clamp((load - high_load) / (low_load - high_load), 0.05, 0.95);
    if (!at(high + (low - high) * share)) return false;
    if (contact_load() > load) {
      low = p.rim.y;
      low_load = contact_load();
    } else {
      high = p.rim.y;
      high_load = contact_load();
    }
  }
  return std::fabs(contact_load() - load) <= 1e-6 * load;
}

bool PressedTyre::pull(const std::vector<NodeForce>& forces) {
  Parts& p = *parts_;
  p.pull.setZero();
  for (const NodeForce& f : forces) {
    if (f.node < 0 || f.node >= p.ring.nodes())
      throw InputError(line("tyre: node %d does not exist; the ring has %d", f.node, p.ring.nodes()));
    p.pull[3L * f.node] += f.x;
    p.pull[3L * f.node + 1] += f.y;
  }
  return settle();
}

bool PressedTyre::settle() { return parts_->solve(parts_->rim, parts_->u); }

const std::string& PressedTyre::reason() const { return parts_->reason; }
int PressedTyre::iterations() const { return parts_->iterations; }
const Rim& PressedTyre::rim() const { return parts_->rim; }
RimLoad PressedTyre::rim_load() const { return parts_->now.rim; }
Vec3d PressedTyre::node(int k) const { return {parts_->u[3L * k], parts_->u[3L * k + 1], 0}; }
const std::vector<ContactPoint>& PressedTyre::points() const { return parts_->now.points; }
double PressedTyre::contact_length() const { return elastic::contact_length(parts_->now.points); }

std::vector<double> PressedTyre::state() const { return {parts_->u.data(), parts_->u.data() + parts_->u.size()}; }

double PressedTyre::contact_load() const {
  double sum = 0;
  for (const ContactPoint& p : points()) sum += p.normal.y * p.pressure * p.area;
  return sum;
}

}  // namespace gonogo::sim::elastic
