#include "terrain/soil_test/cone.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/error.h"

namespace gonogo::terrain {
namespace {

constexpr Index kRestSteps = 100;  // in which the bed takes up its contact laws
constexpr int kSamples = 120;
constexpr int kSides = 24;
constexpr double kShaftShare = 0.783;  // of the cone's diameter: 15.88 mm of 20.27 mm (ASAE S313)

/// Height of a 30 degree cone per diameter of its base.
double cone_height(double diameter) { return diameter / 2 / std::tan(15 * std::numbers::pi / 180); }

/// A ring of corners; returns the index of its first.
Index add_ring(sim::TriangleMesh& mesh, double radius, double z) {
  const auto first = Index(mesh.vertex.size());
  for (int k = 0; k < kSides; ++k) {
    const double angle = 2 * std::numbers::pi * k / kSides;
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

void summarise(ConeResult& r) {
  std::vector<double> depth, pressure;
  for (const ConeSample& s : r.curve)
    if (s.depth >= 0) depth.push_back(s.depth), pressure.push_back(s.pressure);
  const LineFit f = fit_line(depth, pressure);
  r.index = mean_error(pressure).mean;
  r.gradient = f.slope, r.gradient_error = f.slope_error, r.r2 = f.r2;
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
  const double way = (s.depth + cone_height(1)) * s.diameter_grains + 0.5;
  return kRestSteps + Index(way / s.speed * s.steps_per_time);
}

ConeResult cone_test(const TestSoil& soil, const ConeSettings& settings, const TestPace& pace, TestScene* scene) {
  const double d = soil.grain_diameter, diameter = settings.diameter_grains * d;
  if (!(settings.diameter_grains >= 2)) throw InputError("cone test: the cone must be at least two grains wide");
  const double wide = 4.5 * settings.diameter_grains;
  const double deep = std::ceil((settings.depth + cone_height(1)) * settings.diameter_grains + 4);
  const Packing bed = test_bed(soil, wide, wide, deep, pace.threads);
  const double tip = cone_height(diameter), shaft = 2 * settings.depth * diameter + 2 * d;
  sim::SceneWorld world = bed_world(bed, soil.laws(), tip + shaft + 2 * d);
  const std::int32_t mesh = world.add_mesh(cone_mesh(diameter, shaft));
  sim::BodyState state;
  state.position = {bed.spec.length / 2, bed.spec.width / 2, highest_point(bed) + tip + 0.01 * d};
  const sim::BodyIndex cone = world.add_body(state, sim::fixed_body());
  sim::Shape shape;
  shape.type = sim::ShapeType::mesh;
  shape.body = cone;
  shape.material = tool_material;
  shape.surface = mesh;
  world.add_shape(shape);

  const double h = gravity_time(d) / settings.steps_per_time, speed = settings.speed * std::sqrt(9.81 * d);
  TestRun run("cone test", std::move(world), test_settings(d, h, speed, pace), pace);
  run.advance(kRestSteps);
  run.set_velocity(cone, {0, 0, Real(-speed)});
  const Index stride = std::max<Index>(1, (cone_steps(settings) - kRestSteps) / kSamples);
  ConeResult r;
  r.diameter = diameter;
  r.bulk_density = bed.solid_fraction * soil.grain_density;
  const double area = std::numbers::pi / 4 * diameter * diameter;
  for (int k = 0; k < kSamples; ++k) {
    const double before = bed.surface - run.body(cone).position.z;
    const Vec3d force = run.mean_force(cone, stride);
    r.curve.push_back({(before + bed.surface - run.body(cone).position.z) / 2, force.z / area});
  }
  summarise(r);
  r.worst_residual = run.worst_residual();
  if (scene) *scene = {run.world(), run.capture()};
  return r;
}

}  // namespace gonogo::terrain
