#include "sim/elastic/tyre/roll.h"

#include <Eigen/Dense>
#include <cmath>

#include "base/error.h"
#include "base/format.h"
#include "base/progress.h"
#include "sim/elastic/system.h"
#include "sim/elastic/tyre/press.h"
#include "sim/elastic/tyre/ring.h"
#include "sim/elastic/tyre/tread.h"

namespace gonogo::sim::elastic {

struct RollingTyre::Parts {
  Ring ring;
  Hub hub;
  std::vector<RigidShape> ground;
  Rim rim{};
  double time = 0;
  Vector u{}, v{}, outside{}, mass{};
  Rubber rubber{};
  LossyTread tread{};
  std::vector<double> gap{};  // [nodes], where the tread loses energy
  RingShape shape{};
  std::vector<double> before{}, strain{};                  // [kStrains nodes]: last step's; with the branches
  std::array<std::vector<double>, kBranches> stretched{};  // of the branches' springs
  Vector force{}, contact{}, friction{};
  Triplets damping{};  // minus the slopes of the friction by the velocities, 9 for each node that touches
  RimLoad rim_load{};
  std::vector<ContactPoint> points{};
  double contact_energy = 0, start_energy = 0, critical = 0;
  struct Power {
    double work = 0, friction = 0, damping = 0;  // [W]
  } power{};
  struct Motion {
    Vector before{}, after{};            // velocities half a step before and after the last places
    double vy_before = 0, vy_after = 0;  // of the hub [m/s]
  } last{};
  RollEnergy energy{};
  bool started = false;

  void set_mass();
  void start(double height);
  double relax(double h);
  void find_forces(double h);
  Vector change(double h);
  void step(double h);
  double stored() const;
};

void RollingTyre::Parts::set_mass() {
  const auto [m, j] = ring.mass();
  mass.resize(ring.dofs());
  for (int k = 0; k < ring.nodes(); ++k) mass.segment<3>(3L * k) << m, m, j;
}

/// Balance, and the velocity of a ring that flows along its shape while the rim turns.
void RollingTyre::Parts::start(double height) {
  const Tyre& t = ring.tyre();
  PressedTyre pressed(t, std::max(height, 1.05 * t.radius), ground);
  const bool stands = hub.load > 0 && !ground.empty();
  const bool found = stands ? pressed.carry(hub.load) : pressed.move_rim({.y = height});
  if (!found) throw InputError("tyre: no balance at the start: " + pressed.reason());
  rim = pressed.rim();
  u = ring.unloaded(rim);
  const std::vector<double> found_u = pressed.state();
  for (int i = 0; i < ring.dofs(); ++i) u[i] = found_u[std::size_t(i)];
  v = Vector::Zero(ring.dofs());
  const int n = ring.nodes();
  const double rate = hub.spin * n / (4 * std::numbers::pi);
  for (int k = 0; k < n; ++k) {
    const long a = 3L * ((k + 1) % n), b = 3L * ((k + n - 1) % n);
    v.segment<3>(3L * k) = rate * (u.segment<3>(a) - u.segment<3>(b)) + Eigen::Vector3d{hub.speed, 0, hub.spin};
  }
  rim.vx = hub.speed;
  rim.spin = hub.spin;
  outside = Vector::Zero(ring.dofs());
  ring.measure(u, rim, shape);
  before = strain = shape.strain;
  for (auto& s : stretched) s.assign(shape.strain.size(), 0.0);
}

/// Lets the branches follow the strains over a step [J lost].
double RollingTyre::Parts::relax(double h) {
  strain = shape.strain;
  if (!(rubber.branch > 0)) return 0;
  double lost = 0;
  for (int b = 0; b < kBranches; ++b) {
    std::vector<double>& d = stretched[b];
    const double rate = kRate[b];
    const auto [kept, taken] = fading_of(rate, h);
    for (std::size_t first = 0; first < d.size(); first += kStrains) {
      const double earlier = ring.square_of(&d[first]);
      for (std::size_t i = first; i < first + kStrains; ++i) {
        d[i] = kept * d[i] + taken * (shape.strain[i] - before[i]);
        strain[i] += rubber.branch * d[i];
      }
      lost += rubber.settled * rubber.branch * rate * h / 2 * (earlier + ring.square_of(&d[first]));
    }
  }
  for (double& q : strain) q *= rubber.settled;
  before = shape.strain;
  return lost;
}

void RollingTyre::Parts::find_forces(double h) {
  ring.measure(u, rim, shape);
  energy.loss += relax(h);
  force = outside;
  rim_load = ring.add_forces(u, shape, strain, force);
  contact = Vector::Zero(ring.dofs());
  damping.clear();
  for (std::size_t k = 0; k < gap.size(); ++k) gap[k] = ring.gap(u, int(k), ground, time);
  if (!gap.empty()) energy.loss += tread.follow(gap, h);
  const Ring::Touching touching{.ground = ground,
                                .v = v,
                                .time = time,
                                .by_velocity = true,
                                .pressing = gap.empty() ? nullptr : &tread.pressing()};
  contact_energy = ring.add_contact(u, touching, contact, ring.tyre().law.c_t > 0 ? &damping : nullptr, points);
  if (!gap.empty()) contact_energy = tread.energy();
  force += contact;
}

double RollingTyre::Parts::stored() const {
  double sum = ring.energy_of_air(shape) + contact_energy + last.before.dot(mass.cwiseProduct(last.after)) / 2;
  if (hub.load > 0) sum += hub.mass * last.vy_before * last.vy_after / 2;
  for (std::size_t first = 0; first < shape.strain.size(); first += kStrains) {
    double squares = ring.square_of(&shape.strain[first]);
    for (const std::vector<double>& d : stretched) squares += rubber.branch * ring.square_of(&d[first]);
    sum += rubber.settled * squares / 2;
  }
  return sum;
}

/// Change of the velocities in a step. Friction is taken at its end, to first order, so that it bounds no step: it
/// couples the velocities of one node only. `friction` becomes the forces of friction on the nodes.
Vector RollingTyre::Parts::change(double h) {
  Vector dv = h * force.cwiseQuotient(mass);
  friction = Vector::Zero(ring.dofs());
  for (std::size_t j = 0; j < damping.size();) {
    const long i = damping[j].row(), k = i / 3;
    Eigen::Matrix3d c = Eigen::Matrix3d::Zero();
    for (; j < damping.size() && damping[j].row() / 3 == k; ++j)
      c(damping[j].row() - i, damping[j].col() - i) += damping[j].value();
    const Eigen::Vector3d m = mass.segment<3>(i);
    const Eigen::Matrix3d a = Eigen::Matrix3d(m.asDiagonal()) + h * c;
    dv.segment<3>(i) = a.partialPivLu().solve(h * force.segment<3>(i));
    const ContactPoint& p = points[std::size_t(k)];
    const Vec3d arm{p.place.x - u[i], p.place.y - u[i + 1], 0}, shear = p.shear * p.area;
    friction.segment<3>(i) = Eigen::Vector3d{shear.x, shear.y, cross(arm, shear).z} - c * dv.segment<3>(i);
  }
  return dv;
}

/// Velocities lag places by half a step before it and lead them after it. What is stored at a place takes the product
/// of both as the square of the velocity, which linear motion keeps; powers take their mean.
void RollingTyre::Parts::step(double h) {
  find_forces(started ? h : 0);
  const Vector earlier = v;
  const double earlier_vy = rim.vy;
  v += change(h);
  if (hub.load > 0) rim.vy += h / hub.mass * (rim_load.y - hub.load - hub.damping * rim.vy);
  const Vector mean = (v + earlier) / 2;
  const double vy = (rim.vy + earlier_vy) / 2;
  const Power now{.work = outside.dot(mean) - rim_load.x * rim.vx - rim_load.moment * rim.spin - hub.load * vy,
                  .friction = -friction.dot(mean),
                  .damping = hub.load > 0 ? hub.damping * earlier_vy * vy : 0};
  last = {earlier, v, earlier_vy, rim.vy};
  if (started) {
    energy.work += h * (now.work + power.work) / 2;
    energy.friction += h * (now.friction + power.friction) / 2;
    energy.damping += h * (now.damping + power.damping) / 2;
  } else {
    start_energy = stored();
  }
  power = now;
  started = true;
  u += h * v;
  rim.x += h * rim.vx;
  rim.y += h * rim.vy;
  rim.turn += h * rim.spin;
  time += h;
}

RollingTyre::RollingTyre(const Tyre& tyre, const Hub& hub, double height, std::vector<RigidShape> ground)
    : parts_(std::make_unique<Parts>(Parts{.ring = Ring(tyre), .hub = hub, .ground = std::move(ground)})) {
  Parts& p = *parts_;
  if (!(tyre.belt_mass > 0))
    throw InputError(line("tyre: the mass of the belt is %g kg; to roll it must be above 0", tyre.belt_mass));
  if (hub.load > 0 && !(hub.mass > 0))
    throw InputError(line("tyre: the mass that the hub carries is %g kg; with a load it must be above 0", hub.mass));
  p.rubber = rubber_of(tyre.loss);
  if (tyre.loss > 0) {
    if (tyre.law.m_n != 1)
      throw InputError(line("tyre: the tread's exponent m_n is %g; with a loss factor it must be 1", tyre.law.m_n));
    p.tread = LossyTread(tyre.nodes, tyre.law.c_n * tyre.width * p.ring.share(), p.rubber);
    p.gap.resize(std::size_t(tyre.nodes));
  }
  p.set_mass();
  p.start(height);
  p.critical = critical_step();
}

RollingTyre::~RollingTyre() = default;
RollingTyre::RollingTyre(RollingTyre&&) noexcept = default;

double RollingTyre::critical_step() const {
  const Parts& p = *parts_;
  Triplets tangent;
  p.ring.add_tangent(p.u, p.rim, p.rubber.sudden(), tangent);
  const Tyre& t = p.ring.tyre();
  double deepest = 0;  // of the tread
  for (const ContactPoint& c : p.points) deepest = std::max(deepest, -c.gap);
  const double touch = t.law.c_n * t.law.m_n * std::pow(std::max(deepest, 1e-4), t.law.m_n - 1) * t.width *
                       p.ring.share() * p.rubber.sudden();
  for (int k = 0; k < p.ring.nodes(); ++k)
    for (int i = 0; i < 2; ++i) tangent.emplace_back(3 * k + i, 3 * k + i, touch);
  Eigen::SparseMatrix<double> a(p.ring.dofs(), p.ring.dofs());
  a.setFromTriplets(tangent.begin(), tangent.end());
  return 2 / std::sqrt(largest_eigenvalue(a, p.mass));
}

void RollingTyre::advance(double step, long count) {
  Parts& p = *parts_;
  if (!(step > 0 && step <= p.critical))
    throw InputError(
        line("tyre: the step is %g s; it must be above 0 and at most the critical one, %g s", step, p.critical));
  for (long i = 0; i < count; ++i) {
    stop_if_cancelled();
    p.step(step);
  }
}

const Hub& RollingTyre::hub() const { return parts_->hub; }

void RollingTyre::set_motion(double speed, double spin) {
  parts_->hub.speed = parts_->rim.vx = speed;
  parts_->hub.spin = parts_->rim.spin = spin;
}

double RollingTyre::time() const { return parts_->time; }
const Rim& RollingTyre::rim() const { return parts_->rim; }
RimLoad RollingTyre::rim_load() const { return parts_->rim_load; }
double RollingTyre::torque() const { return -parts_->rim_load.moment; }
const std::vector<ContactPoint>& RollingTyre::points() const { return parts_->points; }
double RollingTyre::contact_length() const { return elastic::contact_length(parts_->points); }

Vec3d RollingTyre::ground_force() const {
  Vec3d sum;
  for (const ContactPoint& p : parts_->points) sum += (p.normal * p.pressure + p.shear) * p.area;
  return sum;
}

RollEnergy RollingTyre::energy() const {
  RollEnergy e = parts_->energy;
  if (parts_->started) e.stored = parts_->stored() - parts_->start_energy;
  return e;
}

Vec3d RollingTyre::node(int k) const { return {parts_->u[3L * k], parts_->u[3L * k + 1], 0}; }
Vec3d RollingTyre::velocity(int k) const { return {parts_->v[3L * k], parts_->v[3L * k + 1], 0}; }
double RollingTyre::spin(int k) const { return parts_->v[3L * k + 2]; }

Vec3d RollingTyre::normal(int k) const {
  const double a = 2 * std::numbers::pi * k / parts_->ring.nodes() + parts_->u[3L * k + 2];
  return {std::cos(a), std::sin(a), 0};
}

void RollingTyre::set_load(int k, double fx, double fy, double moment) {
  parts_->outside.segment<3>(3L * k) << fx, fy, moment;
}

RollMeans roll(RollingTyre& tyre, double step, double turns) {
  const double end = std::fabs(tyre.rim().turn) + 2 * std::numbers::pi * turns;
  const RollEnergy before = tyre.energy();
  RollMeans m;
  const double from = tyre.rim().x;
  long count = 0;
  double work = 0;
  for (; std::fabs(tyre.rim().turn) < end; ++count) {
    tyre.advance(step, 1);
    const Vec3d f = tyre.ground_force();
    m.load += f.y;
    m.pull += f.x;
    m.torque -= tyre.torque();
    m.height += tyre.rim().y;
    m.contact_length += tyre.contact_length();
    work -= step * (tyre.rim_load().x * tyre.rim().vx + tyre.rim_load().moment * tyre.rim().spin);
  }
  for (double* x : {&m.load, &m.pull, &m.torque, &m.height, &m.contact_length}) *x /= double(count);
  const RollEnergy after = tyre.energy();
  const double way = tyre.rim().x - from;
  m.lost = (after.loss + after.friction - before.loss - before.friction) / way;
  m.worked = work / way;
  return m;
}

}  // namespace gonogo::sim::elastic
