#include "terrain/bed/clump.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/units.h"

namespace gonogo::terrain {
namespace {

/// Volume V and matrix of second moments, the integral of r r^T over the solid; off the diagonal it is zero in the axes
/// used here.
struct Moments {
  double volume = 0;
  Vec3d square;

  /// Adds a solid of rotation: `axial` and `across` are its second moments about its own centre along its axis and
  /// across it; `at` is its centre, `axis` the unit vector of its axis.
  void add(double sign, double v, double axial, double across, const Vec3d& at, const Vec3d& axis) {
    volume += sign * v;
    const Vec3d along = scale(axis, axis), away = Vec3d{1, 1, 1} - along;
    square += sign * (axial * along + across * away + v * scale(at, at));
  }
};

/// The integral over [from, to] by Gauss and Legendre's three points: exact for polynomials up to the fifth degree.
template <class Function>
double integral(double from, double to, Function f) {
  const double middle = (from + to) / 2, half = (to - from) / 2, off = half * std::sqrt(0.6);
  return half / 9 * (5 * f(middle - off) + 8 * f(middle) + 5 * f(middle + off));
}

/// Adds what two unit spheres with centres `a` and `b` have in common: two caps, base to base. With t the distance from
/// the centre of its sphere, a cap is a stack of discs of radius sqrt(1 - t^2) from t = half the distance on.
void add_lens(double sign, const Vec3d& a, const Vec3d& b, Moments& m) {
  const double p = length(b - a) / 2;
  const auto disc = [](double t) { return 1 - t * t; };  // square of its radius
  const double v = 2 * kPi * integral(p, 1, disc);
  const double axial = 2 * kPi * integral(p, 1, [&](double t) { return (t - p) * (t - p) * disc(t); });
  const double across = kPi / 2 * integral(p, 1, [&](double t) { return disc(t) * disc(t); });
  m.add(sign, v, axial, across, (a + b) * 0.5, (b - a) * (0.5 / p));
}

/// Union of unit spheres of which no three overlap: all of them less what each two have in common.
Moments union_of(const std::vector<Vec3d>& lobe) {
  Moments m;
  for (std::size_t i = 0; i < lobe.size(); ++i) {
    m.add(1, 4 * kPi / 3, 4 * kPi / 15, 4 * kPi / 15, lobe[i], {1, 0, 0});
    for (std::size_t j = 0; j < i; ++j) add_lens(-1, lobe[i], lobe[j], m);
  }
  return m;
}

/// Centres of lobes of unit radius, for which the second moments have principal axes x, y, z.
std::vector<Vec3d> unit_lobes(GrainShape shape) {
  if (shape == GrainShape::pair) return {{-0.5, 0, 0}, {0.5, 0, 0}};
  // Corners of a triangle with sides sqrt(3) lie on the unit circle.
  const double height = std::sqrt(3.0) / 2;
  if (shape == GrainShape::trefoil) return {{1, 0, 0}, {-0.5, height, 0}, {-0.5, -height, 0}};
  return {{}};
}

/// The grain with lobes of unit radius.
Clump with_unit_lobes(GrainShape shape) {
  Clump c;
  c.lobe = unit_lobes(shape);
  c.lobe_radius = 1;
  const Moments m = union_of(c.lobe);
  c.volume = m.volume;
  const Vec3d s = m.square * (1 / m.volume);
  c.inertia_per_mass = {s.y + s.z, s.x + s.z, s.x + s.y};
  c.reach = 1;
  for (const Vec3d& x : c.lobe) c.reach = std::max(c.reach, 1 + length(x));
  return c;
}

/// Made once; of a sphere of radius one the volume is not computed, so that spheres keep their bits.
const Clump& unit_clump(GrainShape shape) {
  static const std::array<Clump, 3> all = [] {
    std::array<Clump, 3> made;
    for (int k = 0; k < 3; ++k) made[std::size_t(k)] = with_unit_lobes(GrainShape(k));
    return made;
  }();
  return all[std::size_t(shape)];
}

}  // namespace

const std::vector<std::string>& grain_shape_names() {
  static const std::vector<std::string> names = {"sphere", "pair", "trefoil"};
  return names;
}

const std::string& name_of(GrainShape shape) { return grain_shape_names()[std::size_t(shape)]; }

GrainShape grain_shape_of(const std::string& name) {
  const auto& names = grain_shape_names();
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end())
    throw InputError("grains: the shape \"" + name + "\" is none of " + names[0] + ", " + names[1] + ", " + names[2]);
  return GrainShape(found - names.begin());
}

Clump clump_of(GrainShape shape, double radius) {
  Clump c = unit_clump(shape);
  const double volume = 4 * kPi / 3 * radius * radius * radius;
  const double a = shape == GrainShape::sphere ? radius : std::cbrt(volume / c.volume);
  for (Vec3d& x : c.lobe) x *= a;
  c.lobe_radius *= a;
  c.volume = volume;
  c.inertia_per_mass *= a * a;
  c.reach *= a;
  return c;
}

sim::BodyIndex add_grain(sim::SceneWorld& world, GrainShape shape, const Grain& grain, double density, int material) {
  if (shape == GrainShape::sphere) return world.add_sphere(grain.position, Real(grain.radius), Real(density), material);
  const Clump c = clump_of(shape, grain.radius);
  const double mass = density * c.volume;
  const sim::BodyIndex body = world.add_body({grain.position, grain.orientation, {}, {}},
                                             sim::solid(Real(mass), static_cast<Vec3>(c.inertia_per_mass * mass)));
  for (const Vec3d& x : c.lobe) {
    sim::Shape lobe;
    lobe.body = body;
    lobe.material = material;
    lobe.offset_B = static_cast<Vec3>(x);
    lobe.size = {Real(c.lobe_radius), 0, 0};
    world.add_shape(lobe);
  }
  return body;
}

std::vector<Grain> lobes_of(GrainShape shape, const std::vector<Grain>& grains) {
  if (shape == GrainShape::sphere) return grains;
  std::vector<Grain> lobes;
  for (const Grain& g : grains) {
    const Clump c = clump_of(shape, g.radius);
    for (const Vec3d& x : c.lobe)
      lobes.push_back({g.position + static_cast<Vec3d>(rotate(g.orientation, static_cast<Vec3>(x))), c.lobe_radius});
  }
  return lobes;
}

void take_places(std::vector<Grain>& grains, GrainShape shape, const std::vector<sim::BodyState>& bodies) {
  GONOGO_ASSERT(bodies.size() >= grains.size());
  for (std::size_t i = 0; i < grains.size(); ++i) {
    grains[i].position = bodies[i].position;
    if (shape != GrainShape::sphere) grains[i].orientation = bodies[i].orientation;
  }
}

Quat mirrored(GrainShape shape, const Quat& q) {
  if (shape == GrainShape::sphere) return q;
  // S is minus half a turn about y, T minus half a turn about z.
  return Quat{0, 0, 1, 0} * q * Quat{0, 0, 0, 1};
}

Quat random_orientation(double u, double v, double w) {
  const double a = std::sqrt(1 - u), b = std::sqrt(u), p = 2 * kPi * v, q = 2 * kPi * w;
  return normalised({Real(b * std::cos(q)), Real(a * std::sin(p)), Real(a * std::cos(p)), Real(b * std::sin(q))});
}

}  // namespace gonogo::terrain
