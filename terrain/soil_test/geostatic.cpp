#include "terrain/soil_test/geostatic.h"

#include <algorithm>
#include <cmath>

#include "base/units.h"

namespace gonogo::terrain {
namespace {

constexpr double kStepsPerTime = 50;  // in sqrt(d / g)
constexpr Index kRestSteps = 400, kMeanSteps = 50;

struct Cut {
  double z;       // height [m]
  double upward;  // force through it, mean [N]
};

/// Adds to every cut the force of the contacts between a body whose centre lies above it and one below; grains of the
/// base lie below all cuts.
void add_forces(TestRun& run, const std::vector<sim::BodyState>& bodies, Index grains, double weight,
                std::vector<Cut>& cuts) {
  const auto contacts = run.simulation().contacts(0);
  const auto impulses = run.simulation().impulses(0);
  const auto height = [&](sim::BodyIndex b) { return b < grains ? bodies[std::size_t(b)].position.z : -1e9; };
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const double a = height(contacts[i].body_a), b = height(contacts[i].body_b);
    // The impulse acts on body a; body b has its opposite.
    const double on_upper = (a > b ? 1 : -1) * double(impulses[i].linear.z);
    for (Cut& c : cuts)
      if (std::max(a, b) > c.z && std::min(a, b) <= c.z) c.upward += weight * on_upper;
  }
}

}  // namespace

GeostaticResult geostatic_test(const TestSoil& soil, double grains_deep, const TestPace& pace) {
  const double d = soil.grain_diameter, h = gravity_time(d) / kStepsPerTime;
  const Packing bed = test_bed(soil, 10, 6, grains_deep, pace.threads);
  const double area = bed.spec.length * bed.spec.width;
  sim::SceneWorld world = bed_world(bed, soil.laws(), 3 * d);
  TestRun run("geostatic test", std::move(world), test_settings(d, h, 0.1 * std::sqrt(kGravity * d), pace), pace);
  run.advance(kRestSteps);
  std::vector<Cut> cuts;
  for (double depth = d; depth < bed.surface; depth += d) cuts.push_back({bed.surface - depth, 0});
  const auto grains = Index(bed.grain.size());
  for (Index k = 0; k < kMeanSteps; ++k) {
    run.advance(1);
    add_forces(run, run.simulation().bodies(0), grains, 1 / (h * double(kMeanSteps)), cuts);
  }
  const auto bodies = run.simulation().bodies(0);
  GeostaticResult r;
  r.solid_fraction = bed.solid_fraction;
  for (const Cut& c : cuts) {
    double weight = 0;
    for (std::size_t i = 0; i < bed.grain.size(); ++i)
      if (bodies[i].position.z > c.z)
        weight += kGravity * soil.grain_density * kPi / 6 * std::pow(2 * bed.grain[i].radius, 3);
    r.profile.push_back({bed.surface - c.z, c.upward / area, weight / area});
    if (bed.surface - c.z > 2.5 * d) r.worst_error = std::max(r.worst_error, std::fabs(c.upward / weight - 1));
  }
  return r;
}

}  // namespace gonogo::terrain
