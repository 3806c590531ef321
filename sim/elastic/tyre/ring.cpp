#include "sim/elastic/tyre/ring.h"

#include <algorithm>
#include <limits>

namespace gonogo::sim::elastic {
namespace {

constexpr double kLeastAngle = 0.2, kMostAngle = 3;  // half the angle of the arc [rad]

/// t with sin t / t = ratio, by Newton's method, which converges on (0, pi) from either side.
double angle_of(double ratio) {
  const double x = std::max(1 - ratio, 0.0);  // t^2 = 6 x + 9/5 x^2 + ..., from the series of the sine
  double t = std::clamp(std::sqrt(x * (6 + 1.8 * x)), kLeastAngle, 2.9);
  for (int k = 0; k < 20; ++k) {
    const double s = std::sin(t), c = std::cos(t);
    const double step = (s - ratio * t) / (c - ratio);
    t = std::clamp(t - step, kLeastAngle / 2, 3.1);
    if (std::fabs(step) < 1e-8) break;  // the next one would be its square
  }
  return t;
}

}  // namespace

Membrane::Membrane(double chord, double bulge, double pressure) : pressure_(pressure) {
  const double radius = (chord * chord / 4 + bulge * bulge) / (2 * bulge);
  length_ = 2 * radius * std::asin(std::min(chord / (2 * radius), 1.0));
}

Pull Membrane::at(double chord) const {
  const double longest = length_ * std::sin(kLeastAngle) / kLeastAngle,
               shortest = length_ * std::sin(kMostAngle) / kMostAngle;
  const double inside = std::clamp(chord, shortest, longest);
  const double t = angle_of(inside / length_), s = std::sin(t), c = std::cos(t), r = length_ / (2 * t);
  Pull pull{.force = pressure_ * r * c,
            .stiffness = pressure_ / 2 * (t * s + c) / (s - t * c),
            .energy = -pressure_ * r * r * (t - s * c)};
  const double beyond = chord - inside;
  pull.energy += pull.force * beyond + pull.stiffness * beyond * beyond / 2;
  pull.force += pull.stiffness * beyond;
  return pull;
}

namespace {

using D6 = Dual<6>;

std::array<int, 6> dofs_of(int a, int b) { return {3 * a, 3 * a + 1, 3 * a + 2, 3 * b, 3 * b + 1, 3 * b + 2}; }

std::array<double, 6> taken(const Vector& u, const std::array<int, 6>& dof) {
  std::array<double, 6> x{};
  for (std::size_t i = 0; i < 6; ++i) x[i] = u[dof[i]];
  return x;
}

}  // namespace

Ring::Ring(const Tyre& tyre)
    : tyre_(tyre),
      share_(2 * std::numbers::pi * tyre.belt_radius() / tyre.nodes),
      chord_(2 * tyre.belt_radius() * std::sin(std::numbers::pi / tyre.nodes)) {
  check_tyre(tyre);
  for (int k = 0; k < tyre.nodes; ++k) {
    const double along = angle_of(k) + std::numbers::pi / tyre.nodes + std::numbers::pi / 2;
    beam_.push_back({chord_, std::cos(along), std::sin(along)});
    unit_.push_back({std::cos(angle_of(k)), std::sin(angle_of(k))});
  }
  if (tyre.bulge > 0) membrane_ = Membrane(tyre.belt_radius() - tyre.rim_radius, tyre.bulge, tyre.pressure);
}

double Ring::angle_of(int k) const { return 2 * std::numbers::pi * k / tyre_.nodes; }

Vector Ring::unloaded(const Rim& rim) const {
  Vector u(dofs());
  for (int k = 0; k < nodes(); ++k) {
    const double a = angle_of(k) + rim.turn;
    u.segment<3>(3L * k) << rim.x + tyre_.belt_radius() * std::cos(a), rim.y + tyre_.belt_radius() * std::sin(a),
        rim.turn;
  }
  return u;
}

void Ring::measure(const Vector& u, const Rim& rim, RingShape& shape) const {
  const auto n = std::size_t(nodes());
  shape.chord.resize(n);
  shape.unit.resize(n);
  shape.from_hub.resize(n);
  shape.strain.resize(kStrains * n);
  shape.area = 0;
  const double c0 = std::cos(rim.turn), s0 = std::sin(rim.turn), r = tyre_.belt_radius();
  for (int k = 0; k < nodes(); ++k) {
    shape.chord[k] = chord_of(beam_[k], taken(u, dofs_of(k, next(k))));
    const auto [c, s] = unit_[k];
    const std::array<double, 2> e{c * c0 - s * s0, s * c0 + c * s0};
    const std::array<double, 2> d{u[3L * k] - rim.x, u[3L * k + 1] - rim.y};
    shape.unit[k] = e;
    shape.from_hub[k] = d;
    double* q = &shape.strain[kStrains * std::size_t(k)];
    for (int i = 0; i < 3; ++i) q[i] = shape.chord[k].strain[i];
    q[3] = d[0] * e[0] + d[1] * e[1] - r;
    q[4] = d[1] * e[0] - d[0] * e[1];
    const long a = 3L * next(k);
    shape.area += (u[3L * k] * u[a + 1] - u[a] * u[3L * k + 1]) / 2;
  }
}

RimLoad Ring::add_forces(const Vector& u, const RingShape& shape, const std::vector<double>& strain,
                         Vector& force) const {
  RimLoad load;
  const double air = tyre_.pressure * tyre_.width / 2;
  for (int k = 0; k < nodes(); ++k) {
    const double* q = &strain[kStrains * std::size_t(k)];
    const auto stress = beam_stress<double>(tyre_.stretching, tyre_.bending, chord_, {q[0], q[1], q[2]});
    const auto f = beam_force(shape.chord[k], stress);
    const auto dof = dofs_of(k, next(k));
    for (std::size_t i = 0; i < 6; ++i) force[dof[i]] += f[i];

    const auto [ex, ey] = shape.unit[k];
    const auto [dx, dy] = shape.from_hub[k];
    const double radial = -tyre_.radial * q[3], across = -tyre_.tangential * q[4];
    double fx = radial * ex - across * ey, fy = radial * ey + across * ex;
    if (tyre_.bulge > 0) {
      const double ax = dx - tyre_.rim_radius * ex, ay = dy - tyre_.rim_radius * ey, c = std::hypot(ax, ay);
      const double pull = 2 * membrane_.at(c).force / c;
      fx -= pull * ax;
      fy -= pull * ay;
    }
    fx *= share_;
    fy *= share_;
    const long a = 3L * next(k), b = 3L * last(k), i = 3L * k;
    force[i] += fx + air * (u[a + 1] - u[b + 1]);
    force[i + 1] += fy + air * (u[b] - u[a]);
    load.x -= fx;
    load.y -= fy;
    load.moment -= dx * fy - dy * fx;
  }
  return load;
}

void Ring::add_tangent(const Vector& u, const Rim& rim, double stiffening, Triplets& tangent) const {
  const double air = tyre_.pressure * tyre_.width / 2;
  for (int k = 0; k < nodes(); ++k) {
    const auto dof = dofs_of(k, next(k));
    std::array<D6, 6> x{};
    for (int i = 0; i < 6; ++i) x[i] = D6::variable(u[dof[i]], i);
    const Chord<D6> chord = chord_of(beam_[k], x);
    const auto stress = beam_stress(stiffening * tyre_.stretching, stiffening * tyre_.bending, chord_, chord.strain);
    const auto f = beam_force(chord, stress);
    for (int i = 0; i < 6; ++i)
      for (int j = 0; j < 6; ++j) tangent.emplace_back(dof[i], dof[j], -f[i].slope[j]);

    const int i = 3 * k, a = 3 * next(k), b = 3 * last(k);
    tangent.emplace_back(i, a + 1, -air);
    tangent.emplace_back(i, b + 1, air);
    tangent.emplace_back(i + 1, b, -air);
    tangent.emplace_back(i + 1, a, air);

    const double angle = angle_of(k) + rim.turn, ex = std::cos(angle), ey = std::sin(angle);
    Eigen::Matrix2d s;
    const Eigen::Vector2d e{ex, ey}, t{-ey, ex};
    s = stiffening * (tyre_.radial * e * e.transpose() + tyre_.tangential * t * t.transpose());
    if (tyre_.bulge > 0) {
      const Eigen::Vector2d arm = u.segment<2>(i) - Eigen::Vector2d{rim.x, rim.y} - tyre_.rim_radius * e;
      const double c = arm.norm();
      const Pull pull = membrane_.at(c);
      const Eigen::Matrix2d along = arm * arm.transpose() / (c * c);
      s += 2 * (pull.stiffness * along + pull.force / c * (Eigen::Matrix2d::Identity() - along));
    }
    for (int r = 0; r < 2; ++r)
      for (int c = 0; c < 2; ++c) tangent.emplace_back(i + r, i + c, share_ * s(r, c));
  }
}

double Ring::square_of(const double* q) const {
  const auto stress = beam_stress<double>(tyre_.stretching, tyre_.bending, chord_, {q[0], q[1], q[2]});
  return stress[0] * q[0] + stress[1] * q[1] + stress[2] * q[2] +
         share_ * (tyre_.radial * q[3] * q[3] + tyre_.tangential * q[4] * q[4]);
}

double Ring::energy_of_air(const RingShape& shape) const {
  double sum = -tyre_.pressure * tyre_.width * shape.area;
  if (!(tyre_.bulge > 0)) return sum;
  for (int k = 0; k < nodes(); ++k) {
    const double ax = shape.from_hub[k][0] - tyre_.rim_radius * shape.unit[k][0],
                 ay = shape.from_hub[k][1] - tyre_.rim_radius * shape.unit[k][1];
    sum += 2 * share_ * membrane_.at(std::hypot(ax, ay)).energy;
  }
  return sum;
}

std::array<double, 2> Ring::mass() const {
  const double m = tyre_.belt_mass / nodes();
  return {m, m * (chord_ * chord_ + 4 * tyre_.tread * tyre_.tread) / 12};
}

/// Normal of the tread at a node, out of the tyre.
std::array<double, 2> Ring::outward(const Vector& u, int k) const {
  const double c = std::cos(u[3L * k + 2]), s = std::sin(u[3L * k + 2]);
  return {unit_[k][0] * c - unit_[k][1] * s, unit_[k][1] * c + unit_[k][0] * s};
}

/// Place of the tread's surface at a node [m].
Vec3d Ring::surface(const Vector& u, int k) const {
  const auto [c, s] = outward(u, k);
  return {u[3L * k] + tyre_.tread * c, u[3L * k + 1] + tyre_.tread * s, 0};
}

double Ring::gap(const Vector& u, int k, const std::vector<RigidShape>& ground, double time) const {
  double least = std::numeric_limits<double>::infinity();
  for (const RigidShape& s : ground) least = std::min(least, gap_above(s, s.displacement(time), surface(u, k)).gap);
  return least;
}

double Ring::contact_of(int k, const RigidShape& shape, const Vector& u, const Touching& at, Vector& force,
                        Triplets* tangent, ContactPoint& point) const {
  using D = Dual<3>;
  const int i = 3 * k;
  const double h = tyre_.tread;
  const Vec3d by = shape.displacement(at.time), plain = surface(u, k);
  double gap = gap_above(shape, by, plain).gap, deeper = 0;
  if (at.pressing != nullptr) {
    const double pressing = (*at.pressing)[k];
    if (pressing > 0) deeper = pressing + gap;
    gap = pressing > 0 ? -pressing : std::max(gap, 0.0);
  }
  if (gap < point.gap) {
    point.gap = gap;
    point.place = plain;
  }
  if (!(gap < 0)) return 0;
  const auto [c, s] = outward(u, k);
  D nx(c), ny(s), px(u[i]), py(u[i + 1]), vx(at.v[i]), vy(at.v[i + 1]), spin(at.v[i + 2]);
  (at.by_velocity ? vx : px).slope[0] = 1;
  (at.by_velocity ? vy : py).slope[1] = 1;
  if (at.by_velocity) {
    spin.slope[2] = 1;
  } else {
    nx.slope[2] = -s;
    ny.slope[2] = c;
  }
  const Vec3T<D> x{px + D(h) * nx, py + D(h) * ny, D(0)};
  const Vec3T<D> v{vx - D(h) * spin * ny, vy + D(h) * spin * nx, D(0)};
  auto above = gap_above(shape, by, x);
  above.gap -= D(deeper);
  const Traction3<3> t = traction_of<3>(tyre_.law, above, v);
  const double area = tyre_.width * share_;
  const Vec3T<D> pull = (above.normal * t.pressure + t.shear) * D(area);
  const D moment = D(h) * (nx * pull.y - ny * pull.x);
  const std::array<D, 3> f{pull.x, pull.y, moment};
  for (int r = 0; r < 3; ++r) {
    force[i + r] += f[r].value;
    if (tangent != nullptr)
      for (int j = 0; j < 3; ++j) tangent->emplace_back(i + r, i + j, -f[r].slope[j]);
  }
  point.normal = value_of(above.normal);
  point.area = area;
  point.pressure = t.pressure.value;
  point.shear = value_of(t.shear);
  point.sliding = value_of(t.sliding);
  point.touch = length(point.sliding) < tyre_.law.epsilon ? Touch::stick : Touch::slip;
  return t.pressure.value * -gap / (tyre_.law.m_n + 1) * area;
}

double Ring::add_contact(const Vector& u, const Touching& at, Vector& force, Triplets* tangent,
                         std::vector<ContactPoint>& points) const {
  points.assign(std::size_t(nodes()), {});
  double energy = 0;
  for (int k = 0; k < nodes(); ++k) {
    points[k].gap = std::numeric_limits<double>::infinity();
    const double least = at.pressing != nullptr ? gap(u, k, at.ground, at.time) : 0;
    for (const RigidShape& shape : at.ground) {
      const bool counts = at.pressing == nullptr ||
                          gap_above(shape, shape.displacement(at.time), surface(u, k)).gap <= least;  // the nearest
      if (counts) energy += contact_of(k, shape, u, at, force, tangent, points[k]);
    }
  }
  return energy;
}

double contact_length(const std::vector<ContactPoint>& points) {
  double sum = 0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    const ContactPoint &a = points[k], &b = points[k + 1 < points.size() ? k + 1 : 0];
    if (a.gap >= 0 && b.gap >= 0) continue;
    const double size = length(b.place - a.place);
    if (a.gap < 0 && b.gap < 0)
      sum += size;
    else
      sum += size * std::min(a.gap, b.gap) / (std::min(a.gap, b.gap) - std::max(a.gap, b.gap));
  }
  return sum;
}

}  // namespace gonogo::sim::elastic
