#include "pipeline/campaign/trial/conditions.h"

#include <cmath>

#include "base/units.h"
#include "pipeline/campaign/trial/trial.h"
#include "terrain/bed/hard_layer.h"
#include "vehicle/compliant_tyre.h"
#include "vehicle/model/assembly.h"

namespace gonogo::campaign {
namespace {

/// Where a wheel stands on the hard layer under weak grains, some of them are pinched and jump away at tens of metres
/// per second. One movement in a million: a trial moves tens of thousands of grains some thousand times.
constexpr Index kMaxSlowed = 200;

double value(const DesignPoint& point, const char* name) { return point.variables.at(contract().variable_index(name)); }

terrain::MacroscopicSoil soil_of(const DesignPoint& point) {
  return {value(point, "friction_angle"), value(point, "cohesion") * 1e3, 0, value(point, "relative_density")};
}

std::size_t packing_of(const TrialSetup& setup, const DesignPoint& point) {
  return terrain::packing_level(setup.calibration, soil_of(point));
}

vehicle::ContactSpring tyre_contact(const TrialSetup& setup, double payload) {
  const double weight = setup.weight(payload), grain = setup.calibration.grain_diameter;
  if (!setup.whole) return vehicle::contact_spring(setup.rig, weight, grain);
  const double wheels = double(vehicle::stations(*setup.whole).size());
  return vehicle::contact_spring(setup.whole->wheel.front(), weight / wheels, grain);
}

}  // namespace

Vec3d bed_gravity(double slope_along_deg, double slope_across_deg, double gravity) {
  // The ground plane rises by tan(along) per metre forward and tan(across) per metre left; its normal is z of the bed.
  const double a = std::tan(slope_along_deg * kDegree), b = std::tan(slope_across_deg * kDegree);
  const double n = std::sqrt(1 + a * a + b * b);
  // With s the slope and psi the heading from the fall line, a = tan s cos psi and b = tan s sin psi: this is
  // -g (sin s cos psi, sin s sin psi, cos s).
  return Vec3d{a, b, 1} * (-gravity / n);
}

TrialConditions conditions_of(const TrialSetup& setup, const DesignPoint& point) {
  TrialConditions c;
  const Vec3d g = bed_gravity(value(point, "slope_along"), value(point, "slope_across"), setup.gravity);
  c.gravity = static_cast<Vec3>(g);
  const std::size_t packing = packing_of(setup, point);
  const sim::PairLaw grain = terrain::contact_law(setup.calibration, soil_of(point), packing);
  // The tyre touches grains with its own friction; soil cohesion acts between grains alone.
  c.laws = {grain, {Real(value(point, "tyre_friction")), Real(setup.wheel_rolling) * grain.rolling_friction, 0}};
  if (setup.compliant_tyres) {
    const vehicle::ContactSpring spring = tyre_contact(setup, value(point, "payload"));
    c.laws.tool.stiffness = Real(spring.stiffness);
    c.laws.tool.damping = Real(spring.damping);
  }
  if (const auto strip = setup.task->strip({})) c.soft = terrain::contact_law(setup.calibration, strip->soil, packing);
  c.payload = value(point, "payload");
  c.speed = value(point, "commanded_speed");
  return c;
}

terrain::BedSpec bed_spec_of(const TrialSetup& setup, const DesignPoint& point) {
  return setup.bed_spec(value(point, "bed_depth"), packing_of(setup, point), point.seed);
}

terrain::Packing settled_bed(const TrialSetup& setup, const DesignPoint& point) {
  terrain::Packing tile = terrain::cached_packing(bed_spec_of(setup, point), setup.packing_folder, 1);
  if (setup.deepest_bed > 0) tile = terrain::on_hard_layer(tile, value(point, "bed_depth"));
  terrain::Packing bed = terrain::tiled(terrain::shifted(tile, point.seed), setup.tiles_along, setup.tiles_across);
  setup.task->shape(setup.course(bed.surface), bed);
  return bed;
}

terrain::Numerics attempt_numerics(const TrialSetup& setup, std::uint64_t attempt) {
  terrain::Numerics n = setup.numerics;
  if (attempt > 1) n.step /= 2;
  return n;
}

sim::StepSettings attempt_settings(const TrialSetup& setup, std::uint64_t attempt) {
  sim::StepSettings s = terrain::step_settings(setup.calibration.grain_diameter, attempt_numerics(setup, attempt));
  s.max_slowed = kMaxSlowed;
  s.recovery_speed *= Real(std::sqrt(setup.gravity / kGravity));  // a tenth of the fall through a grain
  return s;
}

}  // namespace gonogo::campaign
