#include "pipeline/lab/soil/soil_numbers.h"

#include "base/error.h"
#include "base/format.h"
#include "base/json/config.h"
#include "base/line.h"
#include "base/nearest.h"
#include "pipeline/campaign/trial/setup.h"
#include "pipeline/lab/soil/test_runs.h"
#include "terrain/soil/soil_file.h"
#include "terrain/soil/table_numerics.h"

namespace gonogo::lab {
namespace {

terrain::SoilState state_of(const std::filesystem::path& file, const std::string& wanted) {
  std::vector<std::string> names;
  for (const terrain::SoilState& s : terrain::read_soil(file).states) {
    if (wanted.empty() || s.name == wanted) return s;
    names.push_back(s.name);
  }
  throw InputError(file.string() + ": no state \"" + wanted + "\"; it has: " + join_words(names));
}

/// The tests' request for the grains that the table gives the soil.
SoilTestRequest request_of(const SoilNumbersRequest& r, const terrain::Calibration& c, const terrain::SoilFit& fit) {
  SoilTestRequest t;
  t.soil.grain_diameter = c.grain_diameter;
  t.soil.shape = c.shape;
  t.soil.grain = fit.law;
  t.soil.relative_density = terrain::relative_density_of(c.packing[fit.packing].settle_friction);
  t.soil.grain_density = fit.grain_density;
  t.soil.packing_folder = campaign::default_packing_folder();
  t.seeds = r.seeds;
  t.stresses = r.stresses;
  t.plate_widths = r.plate_widths;
  t.quick = r.quick;
  t.threads = r.threads;
  t.numerics = terrain::numerics_by_table(c, r.calibration);
  return t;
}

Measure janosi_of(const std::vector<terrain::ShearResult>& results, double grain_diameter) {
  std::vector<double> k;
  for (const terrain::ShearResult& r : results) {
    std::vector<double> displacement, stress;
    for (const terrain::ShearSample& s : r.curve) {
      displacement.push_back(s.travel * grain_diameter);
      stress.push_back(s.shear_stress);
    }
    k.push_back(terrain::fit_janosi(displacement, stress, r.shear_stress));
  }
  const MeanError mean = mean_error(k);
  return {mean.mean, mean.error};
}

}  // namespace

SoilNumbers measure_soil_numbers(const SoilNumbersRequest& r) {
  const terrain::SoilState state = state_of(r.soil, r.state);
  terrain::Calibration c = terrain::read_calibration(r.calibration);
  if (r.grain > 0) c.grain_diameter = r.grain;
  const terrain::SoilFit fit = terrain::fit_soil(c, state.macroscopic());
  const SoilTestRequest tests = request_of(r, c, fit);
  const auto plates = run_plates(tests, nullptr);
  const auto sheared = run_shear(tests, nullptr);
  const terrain::BekkerFit bekker = fit_bekker(plates);
  const terrain::ShearStrength strength = shear_strength(sheared);
  SoilNumbers n{.soil = r.soil.stem().string(), .state = state.name, .table = r.calibration.filename().string()};
  n.grain_diameter = c.grain_diameter;
  n.n = {bekker.n, bekker.n_error};
  n.k_c = {bekker.k_c, bekker.k_c_error};
  n.k_phi = {bekker.k_phi, bekker.k_phi_error};
  n.cohesion = {strength.steady_cohesion, strength.steady_cohesion_error};
  n.friction_angle = {strength.steady_angle.degrees, strength.steady_angle.error};
  n.peak_cohesion = {strength.peak_cohesion, strength.peak_cohesion_error};
  n.peak_friction_angle = {strength.peak_angle.degrees, strength.peak_angle.error};
  n.janosi = janosi_of(sheared, c.grain_diameter);
  n.bulk_density = fit.bulk_density;
  n.plate_r2 = bekker.r2;
  n.shear_r2 = strength.steady_r2;
  for (const double w : r.plate_widths) n.plate_widths.push_back(w * c.grain_diameter);
  n.stresses = r.stresses;
  return n;
}

}  // namespace gonogo::lab
