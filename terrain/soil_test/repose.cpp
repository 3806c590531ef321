#include "terrain/soil_test/repose.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/units.h"

namespace gonogo::terrain {
namespace {

constexpr double kRestTime = 10;            // waited at most so many times the height's own time sqrt(h / g)
constexpr int kSmooth = tool_material + 1;  // walls and gate: a rough gate would drag grains into the gap at the base
constexpr std::int32_t kWallGroup = 1;      // walls, gate, base and pit never touch each other

struct Place {
  double end;    // of the bed: the gate's face [m]
  double pit;    // floor of the pit [m]
  double reach;  // end of the pit [m]
};

/// Largest reach of a grain from its centre of mass [m].
double largest_reach(const BedSpec& s) { return clump_of(s.shape, s.grain_diameter / 2).reach * (1 + s.size_spread); }

Place place_of(const Packing& bed) {
  const BedSpec& s = bed.spec;
  const double d = s.grain_diameter, end = s.length + largest_reach(s);
  return {end, -(bed.surface + 3 * d), end + 1.2 * s.length};
}

void add_wall(sim::SceneWorld& world, const Vec3d& point, const Quat& turn, int material) {
  sim::BodyState state;
  state.position = point;
  sim::Shape plane;
  plane.type = sim::ShapeType::plane;
  plane.body = world.add_body(state, sim::fixed_body());
  plane.material = material;
  plane.group = kWallGroup;
  plane.turn_B = turn;
  world.add_shape(plane);
}

/// Quaternion that turns z to +x or -x.
Quat z_to_x(double sign) {
  const double half = std::sqrt(0.5);
  return {Real(half), 0, Real(sign * half), 0};
}

/// The gate: a slab one grain thick from the pit's floor to above the bed, whose body is prescribed to sink through
/// that floor, so that no grain gets under it.
sim::BodyIndex add_gate(sim::SceneWorld& world, const Packing& bed, const Place& place) {
  const BedSpec& s = bed.spec;
  const double d = s.grain_diameter, high = bed.surface + d - place.pit;
  sim::BodyState state;
  state.position = {place.end + d / 2, s.width / 2, bed.surface + d - high / 2};
  sim::Shape box;
  box.type = sim::ShapeType::box;
  box.body = world.add_body(state, sim::fixed_body());
  box.material = kSmooth;
  box.group = kWallGroup;
  box.size = {Real(d / 2), Real(s.width / 2), Real(high / 2)};
  world.add_shape(box);
  return box.body;
}

sim::SceneWorld repose_world(const TestSoil& soil, const Packing& bed, const Place& place, sim::BodyIndex& gate) {
  const BedSpec& s = bed.spec;
  const double d = s.grain_diameter, wall = -largest_reach(s);
  sim::SceneWorld world = bed_world(bed, soil.laws(), 2 * d);
  world.set_law(grain_material, kSmooth, {});
  for (sim::Shape& shape : world.shape)
    if (shape.material == base_material) shape.group = kWallGroup;
  world.periodic_x = false;
  world.origin = {wall - d, 0, place.pit - bed.surface - 4 * d};
  world.size = {place.reach + d - world.origin.x, s.width, bed.surface + 2 * d - world.origin.z};
  add_wall(world, {wall, 0, 0}, z_to_x(1), kSmooth);
  add_wall(world, {place.reach, 0, 0}, z_to_x(-1), kSmooth);
  add_wall(world, {0, 0, place.pit}, {}, tool_material);
  gate = add_gate(world, bed, place);
  return world;
}

/// Heights of the surface left of the gate, one column per grain diameter.
std::vector<ReposeSample> profile_of(Packing bed, const std::vector<sim::BodyState>& bodies) {
  const BedSpec& s = bed.spec;
  take_places(bed.grain, s.shape, bodies);
  const int nx = int(std::lround(s.length / s.grain_diameter)), ny = int(std::lround(s.width / s.grain_diameter));
  std::vector<double> top(std::size_t(nx) * std::size_t(ny), 0.0);
  for (const Grain& g : lobes_of(s.shape, bed.grain)) {
    const Vec3d& p = g.position;
    const int column = int(std::floor(p.x / s.length * nx));
    const int row = std::clamp(int(std::floor(p.y / s.width * ny)), 0, ny - 1);
    if (column < 0 || column >= nx || p.z < 0) continue;
    double& highest = top[std::size_t(row) * std::size_t(nx) + std::size_t(column)];
    highest = std::max(highest, p.z + g.radius);
  }
  std::vector<ReposeSample> profile;
  for (int c = 0; c < nx; ++c) {
    double mean = 0;
    for (int r = 0; r < ny; ++r) mean += top[std::size_t(r) * std::size_t(nx) + std::size_t(c)] / ny;
    profile.push_back({(c + 0.5) * s.length / nx, mean});
  }
  return profile;
}

/// The slope between a seventh and six sevenths of the height that is left, away from crest and toe.
void fit_slope(ReposeResult& r, double diameter) {
  double highest = 0;
  for (const ReposeSample& s : r.profile) highest = std::max(highest, s.height);
  std::size_t crest = 0;
  for (std::size_t k = 0; k < r.profile.size(); ++k)
    if (r.profile[k].height > 6.0 / 7 * highest) crest = k;
  std::vector<double> x, z;
  for (std::size_t k = crest; k < r.profile.size(); ++k)
    if (r.profile[k].height > std::max(highest / 7, 1.5 * diameter)) {
      x.push_back(r.profile[k].x);
      z.push_back(r.profile[k].height);
    }
  if (x.size() < 4) {
    // Steeper than four columns: the bed stands as a cliff.
    r.angle = {90, 0};
    return;
  }
  const LineFit f = fit_line(x, z);
  r.angle = angle_of_tangent(-f.slope, f.slope_error);
  r.r2 = f.r2;
}

}  // namespace

Index repose_steps(const ReposeSettings& settings) {
  const double times = (settings.height + 2) / settings.gate_speed + kRestTime * std::sqrt(settings.height);
  return 100 + Index(times * settings.steps_per_time);
}

ReposeResult repose_test(const TestSoil& soil, const ReposeSettings& settings, const TestPace& pace, TestScene* scene) {
  const double d = soil.grain_diameter, h = gravity_time(d) / settings.steps_per_time, unit = std::sqrt(kGravity * d);
  const Packing bed = test_bed(soil, settings.length, settings.width, settings.height, pace.threads);
  const Place place = place_of(bed);
  sim::BodyIndex gate = 0;
  sim::SceneWorld world = repose_world(soil, bed, place, gate);
  const double speed = settings.gate_speed * unit, way = bed.surface + 2 * d;
  TestRun run("repose test", std::move(world), test_settings(d, h, speed, pace), pace);
  run.advance(100);
  run.set_velocity(gate, {0, 0, Real(-speed)});
  const auto sinking = Index(way / speed / h);
  for (Index k = 0; k < sinking; k += 50) run.advance(std::min<Index>(50, sinking - k));
  run.set_velocity(gate, {});
  // Quiet: grains need longer than five of their own times to move by a tenth of a diameter.
  const auto max_steps = Index(kRestTime * std::sqrt(settings.height) * settings.steps_per_time);
  ReposeResult r;
  for (Index k = 0; k < max_steps; k += 50) {
    run.advance(50);
    r.rest_speed = run.rms_speed(bed.grain.size());
    if (r.rest_speed < 0.02 * unit) break;
  }
  const auto bodies = run.bodies();
  r.profile = profile_of(bed, bodies);
  fit_slope(r, d);
  for (std::size_t i = 0; i < bed.grain.size(); ++i)
    if (bodies[i].position.x > place.end) r.spilled += 1.0 / double(bed.grain.size());
  r.worst_residual = run.worst_residual();
  if (scene) *scene = {run.world(), run.capture()};
  return r;
}

}  // namespace gonogo::terrain
