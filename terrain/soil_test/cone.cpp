#include "terrain/soil_test/cone.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/format.h"
#include "base/units.h"
#include "sim/scene/build_joint.h"

namespace gonogo::terrain {
namespace {

constexpr Index kRestSteps = 100;  // in which the bed takes up its contact laws
constexpr int kSamples = 120;
constexpr int kDepths = 60;  // at which pressure is read for index and gradient
constexpr int kSides = 24;
constexpr double kShaftShare = 0.783;  // of the cone's diameter: 15.88 mm of 20.27 mm (ASAE S313)

/// Height of a 30 degree cone per diameter of its base.
double cone_height(double diameter) { return diameter / 2 / std::tan(to_radians(15)); }

/// A ring of corners; returns the index of its first.
Index add_ring(sim::TriangleMesh& mesh, double radius, double z) {
  const auto first = Index(mesh.vertex.size());
  for (int k = 0; k < kSides; ++k) {
    const double angle = 2 * kPi * k / kSides;
    mesh.vertex.push_back({Real(radius * std::cos(angle)), Real(radius * std::sin(angle)), Real(z)});
  }
  return first;
}

/// The band between a ring and the one above it, seen from outside.
void add_band(sim::TriangleMesh& mesh, Index low, Index high) {
  for (int k = 0; k < kSides; ++k) {
    const int next = (k + 1) % kSides;
    mesh.triangle.push_back({low + k, low + next, high + next});
    mesh.triangle.push_back({low + k, high + next, high + k});
  }
}

double base_area(double diameter) { return kPi / 4 * diameter * diameter; }

/// A cone on vertical rails, as heavy as the soil under its base to a depth of one diameter, and what pushes it.
struct Penetrometer {
  sim::BodyIndex cone = 0, drive = 0;
};

Penetrometer add_penetrometer(sim::SceneWorld& world, const Packing& bed, double diameter, double shaft,
                              double unit_weight, double ring) {
  const double mass = unit_weight / kGravity * base_area(diameter) * diameter;
  const double stiffness = ring * unit_weight * base_area(diameter), damping = 2 * std::sqrt(stiffness * mass);
  sim::BodyState state;
  state.position = {bed.spec.length / 2, bed.spec.width / 2,
                    highest_point(bed) + cone_height(diameter) + 0.01 * bed.spec.grain_diameter};
  Penetrometer p;
  p.cone = world.add_body(state, on_vertical_rails(mass));
  p.drive = world.add_body(state, sim::fixed_body());
  sim::Shape shape;
  shape.type = sim::ShapeType::mesh;
  shape.body = p.cone;
  shape.material = tool_material;
  shape.surface = world.add_mesh(cone_mesh(diameter, shaft));
  world.add_shape(shape);
  const Vec3d at = state.position;
  world.spring.push_back(sim::spring_along(world, p.cone, p.drive, at, at, {0, 0, 1}, stiffness, damping));
  return p;
}

/// Pressures of the curve at even depths down to `end`, in straight lines between its samples.
std::vector<ConeSample> even_depths(const std::vector<ConeSample>& curve, double end) {
  std::vector<ConeSample> profile;
  std::size_t next = 1;
  for (int k = 0; k <= kDepths; ++k) {
    const double z = end * k / kDepths;
    while (next + 1 < curve.size() && curve[next].depth < z) ++next;
    const ConeSample &a = curve[next - 1], &b = curve[next];
    const double share = b.depth > a.depth ? std::clamp((z - a.depth) / (b.depth - a.depth), 0.0, 1.0) : 1;
    profile.push_back({z, a.pressure + share * (b.pressure - a.pressure)});
  }
  return profile;
}

}  // namespace

sim::TriangleMesh cone_mesh(double diameter, double shaft_length) {
  sim::TriangleMesh mesh;
  mesh.name = "cone";
  mesh.vertex.push_back({0, 0, Real(-cone_height(diameter))});
  const Index base = add_ring(mesh, diameter / 2, 0);
  for (int k = 0; k < kSides; ++k) mesh.triangle.push_back({0, base + (k + 1) % kSides, base + k});
  const Index shaft = add_ring(mesh, kShaftShare * diameter / 2, 0.1 * diameter);
  const Index top = add_ring(mesh, kShaftShare * diameter / 2, shaft_length);
  add_band(mesh, base, shaft);
  add_band(mesh, shaft, top);
  const auto middle = Index(mesh.vertex.size());
  mesh.vertex.push_back({0, 0, Real(shaft_length)});
  for (int k = 0; k < kSides; ++k) mesh.triangle.push_back({middle, top + k, top + (k + 1) % kSides});
  return mesh;
}

Index cone_steps(const ConeSettings& s) {
  constexpr double usual_pressure = 80;  // at the end, in unit weights times cone diameters: how far the spring gives
  const double way = (s.depth + cone_height(1) + usual_pressure / s.ring) * s.diameter_grains + 0.5;
  return kRestSteps + Index(way / s.speed * s.steps_per_time);
}

ConeResult cone_test(const TestSoil& soil, const ConeSettings& settings, const TestPace& pace, TestScene* scene) {
  const double d = soil.grain_diameter, diameter = settings.diameter_grains * d;
  if (!(settings.diameter_grains >= 2)) throw InputError("cone test: the cone must be at least two grains wide");
  const double wide = 4.5 * settings.diameter_grains;
  const double deep = std::ceil((settings.depth + cone_height(1)) * settings.diameter_grains + 4);
  const Packing bed = test_bed(soil, wide, wide, deep, pace.threads);
  const double tip = cone_height(diameter), shaft = 2 * settings.depth * diameter + 2 * d;
  const double h = gravity_time(d) / settings.steps_per_time, speed = settings.speed * std::sqrt(kGravity * d);
  ConeResult r;
  r.diameter = diameter;
  r.bulk_density = bed.solid_fraction * soil.grain_density;
  sim::SceneWorld world = bed_world(bed, soil.laws(), tip + shaft + 2 * d);
  const Penetrometer p = add_penetrometer(world, bed, diameter, shaft, r.bulk_density * kGravity, settings.ring);
  TestRun run("cone test", std::move(world), test_settings(d, h, speed, pace), pace);
  run.advance(kRestSteps);
  run.set_velocity(p.drive, {0, 0, Real(-speed)});
  const Index stride = std::max<Index>(1, (cone_steps(settings) - kRestSteps) / kSamples);
  const double end = settings.depth * diameter;
  do {
    const double before = bed.surface - run.body(p.cone).position.z;
    const Vec3d force = run.mean_force(p.cone, stride);
    r.curve.push_back({(before + bed.surface - run.body(p.cone).position.z) / 2, force.z / base_area(diameter)});
    if (r.curve.back().pressure > settings.max_pressure)
      throw DeviceError("cone test: the soil bears " + number_text(r.curve.back().pressure) +
                        " Pa with the cone's base " + number_text(r.curve.back().depth) +
                        " m below the surface; it is too strong for the test");
  } while (r.curve.back().depth < end);
  r.profile = even_depths(r.curve, end);
  for (const ConeSample& s : r.profile) r.index += s.pressure / double(r.profile.size());
  r.worst_residual = run.worst_residual();
  if (scene) *scene = {run.world(), run.capture()};
  return r;
}

std::vector<ConeSample> mean_profile(const std::vector<ConeResult>& tests) {
  std::vector<ConeSample> mean(tests.at(0).profile.size(), {0, 0});
  for (std::size_t k = 0; k < mean.size(); ++k) {
    mean[k].depth = tests[0].profile[k].depth;
    for (const ConeResult& t : tests) mean[k].pressure += t.profile[k].pressure / double(tests.size());
  }
  return mean;
}

LineFit fit_cone(const std::vector<ConeResult>& tests) {
  std::vector<double> depth, pressure;
  for (const ConeSample& s : mean_profile(tests)) {
    depth.push_back(s.depth);
    pressure.push_back(s.pressure);
  }
  return fit_line(depth, pressure);
}

}  // namespace gonogo::terrain
