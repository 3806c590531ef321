#include "pipeline/lab/soil/test_runs.h"

#include "base/line.h"

namespace gonogo::lab {
namespace {

double steps_per(double time, double own, const SoilTestRequest& r) {
  return r.numerics ? time / r.numerics->step : own;
}

/// What was tested, the same for all tests.
Json soil_json(const SoilTestRequest& r) {
  Json j;
  j["grain_diameter_m"] = r.soil.grain_diameter;
  j["shape"] = terrain::name_of(r.soil.shape);
  j["friction"] = double(r.soil.grain.friction);
  j["rolling_friction"] = double(r.soil.grain.rolling_friction);
  j["cohesion_pressure_Pa"] = double(r.soil.grain.cohesion_pressure);
  j["tool_friction"] = r.soil.tool_friction;
  j["relative_density"] = r.soil.relative_density;
  j["grain_density_kg_per_m3"] = r.soil.grain_density;
  j["seeds"] = r.seeds;
  j["first_seed"] = std::uint64_t(r.soil.seed);
  if (r.numerics) terrain::write_numerics(j["numerics"], *r.numerics);
  return j;
}

}  // namespace

double steps_per_gravity_time(double own, const SoilTestRequest& r) {
  return steps_per(terrain::gravity_time(r.soil.grain_diameter), own, r);
}

double steps_per_stress_time(double stress, double own, const SoilTestRequest& r) {
  return steps_per(terrain::stress_time(r.soil.grain_diameter, r.soil.grain_density, stress), own, r);
}

Json angle_json(const terrain::Angle& a) {
  Json j;
  j["deg"] = a.degrees;
  j["error_deg"] = a.error;
  return j;
}

SoilTestOutcome begin(const std::string& test, const SoilTestRequest& r) {
  SoilTestOutcome o;
  o.json["test"] = test;
  o.json["soil"] = soil_json(r);
  o.plot.title = line("Virtual %s test: %ss of %g mm, friction %g, rolling %g", test.c_str(),
                      terrain::name_of(r.soil.shape).c_str(), 1e3 * r.soil.grain_diameter,
                      double(r.soil.grain.friction), double(r.soil.grain.rolling_friction));
  if (r.soil.grain.cohesion_pressure > 0)
    o.plot.title += line(", cohesion pressure %g kPa", double(r.soil.grain.cohesion_pressure) / 1e3);
  return o;
}

void finish(SoilTestOutcome& o, double worst_residual) {
  o.json["worst_rms_residual_m_per_s"] = worst_residual;
  o.text += line("worst residual of a step, rms: %.2e m/s\n", worst_residual);
}

terrain::TestSoil seeded(const SoilTestRequest& r, std::size_t k) {
  terrain::TestSoil soil = r.soil;
  soil.seed += k;
  return soil;
}

std::vector<Load> loads_of(const SoilTestRequest& r) {
  std::vector<Load> loads;
  for (const double stress : r.stresses)
    for (std::size_t s = 0; s < std::size_t(r.seeds); ++s) loads.push_back({stress, s});
  return loads;
}

}  // namespace gonogo::lab
