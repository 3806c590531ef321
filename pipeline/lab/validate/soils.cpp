#include "pipeline/lab/validate/soils.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "base/error.h"
#include "base/files/shipped.h"
#include "base/format.h"
#include "base/parallel/host_loop.h"
#include "base/progress.h"
#include "pipeline/inspect/soil_tests.h"
#include "terrain/soil/calibration.h"
#include "terrain/soil/soil.h"
#include "terrain/soil_test/strength_test.h"
#include "terrain/soil_test/test_run.h"

namespace gonogo::lab {
namespace {

using inspect::run_soil_test;
using inspect::SoilTestOutcome;
using inspect::SoilTestRequest;
using terrain::Calibration;

/// Sandy grains of the calibration's size, between loose and dense.
SoilTestRequest request_of(const SoilValidation& run, double rolling, double density) {
  SoilTestRequest r;
  const Calibration table = terrain::read_calibration(run.calibration);
  r.soil.grain_diameter = table.grain_diameter;
  r.soil.shape = table.shape;
  r.soil.grain = {Real(0.5), Real(rolling), 0};
  r.soil.relative_density = density;
  r.seeds = run.seeds;
  r.threads = run.threads;
  r.quick = run.quick;
  return r;
}

CheckFigure figure_of(const std::string& name, const SoilTestOutcome& o) {
  return {"soils_" + name, o.csv, o.plot, {}};
}

CheckFigure shear(const SoilValidation& run) {
  SoilTestRequest r = request_of(run, 0.1, 0.5);
  r.stresses = {3.1e3, 6.4e3, 12.5e3, 24.2e3};  // those of the direct shear box in Chrono's validation
  const SoilTestOutcome o = run_soil_test("shear", r);
  CheckFigure f = figure_of("shear", o);
  f.check = {{"shear_r2", "shear: shear stress is linear in normal stress, R2", 0.98, 1, o.shear->peak_r2},
             {"shear_peak_over_steady", "shear: peak friction angle less the steady one [deg]", 0, 20,
              o.shear->peak_angle.degrees - o.shear->steady_angle.degrees},
             {"shear_cohesion_share", "shear: cohesion of cohesionless grains over the largest stress", -0.05, 0.05,
              o.shear->steady_cohesion / 24.2e3}};
  return f;
}

CheckFigure triaxial(const SoilValidation& run) {
  const SoilTestRequest r = request_of(run, 0.1, 0.5);
  const SoilTestOutcome t = run_soil_test("triaxial", r), s = run_soil_test("shear", r);
  CheckFigure f = figure_of("triaxial", t);
  f.check = {{"triaxial_less_shear_deg", "triaxial: steady friction angle less that of shear [deg]", -3, 3,
              t.triaxial->strength.steady_angle.degrees - s.shear->steady_angle.degrees}};
  return f;
}

/// On a loose bed, which gives way as it is pressed: a power law is for such soils. Denser ones carry a plate until
/// they fail beside it, and hardly more from then on.
CheckFigure plate(const SoilValidation& run) {
  const SoilTestOutcome o = run_soil_test("plate", request_of(run, 0.1, 0));
  CheckFigure f = figure_of("plate", o);
  f.check = {{"plate_n", "plate: Bekker's exponent over two widths, loose bed", 0.7, 1.3, o.plate->n},
             {"plate_k_phi", "plate: k_phi [kN/m^(n+2)]", 0, 1e9, o.plate->k_phi / 1e3}};
  return f;
}

/// Single grains before the cone rule what one bed says; the mean of eight is about that of many grains.
CheckFigure cone(const SoilValidation& run) {
  SoilTestRequest in_loose = request_of(run, 0.1, 0), in_dense = request_of(run, 0.1, 1);
  in_loose.seeds = in_dense.seeds = std::max(8, run.seeds);
  const SoilTestOutcome loose = run_soil_test("cone", in_loose), dense = run_soil_test("cone", in_dense);
  CheckFigure f = figure_of("cone", dense);
  for (report::PlotLine& l : f.plot.lines) l.label = "densest, " + l.label;
  for (report::PlotLine l : loose.plot.lines) {
    l.label = "loosest, " + l.label;
    l.colour = 1;
    f.plot.lines.push_back(l);
  }
  f.plot.notes = {"densest: " + dense.plot.notes[0], "loosest: " + loose.plot.notes[0]};
  f.csv = "# densest\n" + dense.csv + "# loosest\n" + loose.csv;
  f.check = {{"cone_dense_over_loose", "cone: index of the densest over that of the loosest bed", 1.05, 100,
              dense.cone->index.mean / 1e3 / (loose.cone->index.mean / 1e3)},
             {"cone_r2", "cone: pressure is about linear in depth, densest beds, R2", 0.85, 1, dense.cone->gradient.r2},
             {"cone_r2_loose", "cone: the same, loosest beds", 0.85, 1, loose.cone->gradient.r2}};
  return f;
}

CheckFigure repose(const SoilValidation& run) {
  const SoilTestOutcome rolls = run_soil_test("repose", request_of(run, 0, 0.5)),
                        resists = run_soil_test("repose", request_of(run, 0.3, 0.5));
  CheckFigure f = figure_of("repose", resists);
  f.check = {{"repose_rolling_gain_deg", "repose: what rolling friction 0.3 adds to the slope [deg]", 2, 40,
              resists.repose->angle.degrees - rolls.repose->angle.degrees},
             {"repose_deg", "repose: slope of spheres that roll [deg]", 12, 30, rolls.repose->angle.degrees}};
  return f;
}

CheckFigure geostatic(const SoilValidation& run) {
  terrain::TestPace pace;
  pace.threads = run.threads;
  const auto r = geostatic_test(request_of(run, 0.1, 0.5).soil, run.quick ? 8 : 16, pace);
  CheckFigure f{.name = "soils_geostatic", .csv = "depth_m,vertical_stress_Pa,weight_above_Pa\n"};
  f.plot.title = "Bed under its own weight";
  f.plot.x_label = "depth [m]";
  f.plot.y_label = "vertical stress [kPa]";
  f.plot.lines = {{"weight above", {}, {}, false}, {"carried by contacts", {}, {}, true}};
  for (const auto& s : r.profile) {
    f.csv += line("%.5f,%.3f,%.3f\n", s.depth, s.stress, s.weight);
    for (report::PlotLine& l : f.plot.lines) l.x.push_back(s.depth);
    f.plot.lines[0].y.push_back(s.weight / 1e3);
    f.plot.lines[1].y.push_back(s.stress / 1e3);
  }
  f.check = {{"geostatic_worst", "geostatic: largest error of the vertical stress", 0, 0.05, r.worst_error}};
  return f;
}

/// One soil of the inversion: asked for, and measured on grains that the calibration gives it.
struct Inverted {
  std::string name;
  terrain::MacroscopicSoil soil;
  terrain::SoilFit fit;
  double friction_angle = 0, angle_error = 0, cohesion = 0, cohesion_error = 0, bulk_density = 0;

  /// Least confining stress of its tests [Pa]: the contacts' pull, up to which tables know cohesion as a share of it.
  double min_stress() const { return std::max(2.5e3, double(fit.law.cohesion_pressure)); }
};

constexpr double kInversionStress[] = {1, 2, 4, 8};  // times the least
constexpr std::uint64_t kNewSeed = 1001;             // packings that no calibration saw

std::vector<Inverted> soils_of(const Calibration& c) {
  std::vector<Inverted> soils;
  for (const char* name : {"dry_sand", "lete_sand", "sandy_loam", "grc1", "lean_clay"}) {
    const auto file = terrain::read_soil(shipped_file("soils", "soil", name));
    const terrain::MacroscopicSoil soil = as_triaxial(c, file.states.front().macroscopic());
    try {
      soils.push_back({file.name, soil, fit_soil(c, soil)});
    } catch (const InputError&) {
      // Out of these grains' reach: the table says so to everybody who asks for this soil.
    }
  }
  return soils;
}

/// A specimen of the soil's grains under one confining stress, at the numerics of the table's trials.
terrain::TriaxialResult compressed(const Calibration& c, const std::filesystem::path& table,
                                   const terrain::SoilFit& fit, double stress, std::uint64_t seed) {
  terrain::TestSoil soil;
  soil.grain_diameter = c.grain_diameter;
  soil.shape = c.shape;
  soil.grain = fit.law;
  soil.grain_density = fit.grain_density;
  soil.relative_density = terrain::relative_density_of(c.packing[fit.packing].settle_friction);
  soil.seed = seed;
  terrain::TriaxialSettings settings;
  settings.confining_stress = stress;
  const terrain::Numerics numerics = terrain::numerics_by_table(c, table);
  settings.steps_per_time = terrain::stress_time(c.grain_diameter, fit.grain_density, stress) / numerics.step;
  const terrain::TestPace pace = terrain::pace_of(numerics);
  return triaxial_test(soil, settings, pace);
}

/// Bulk density of a bed that no calibration saw [kg/m^3].
double bulk_density_of(const Calibration& c, const terrain::SoilFit& fit, std::uint64_t seed) {
  const double friction = c.packing[fit.packing].settle_friction;
  return settle_packing(terrain::shear_cell(c.grain_diameter, friction, seed, c.shape), 1).solid_fraction *
         fit.grain_density;
}

void measure(const SoilValidation& run, const Calibration& c, std::vector<Inverted>& soils) {
  const std::size_t loads = std::size(kInversionStress), each = loads * std::size_t(run.seeds);
  std::vector<terrain::TriaxialResult> results(soils.size() * each);
  std::vector<double> density(results.size());
  Progress progress("validate soils inversion", "tests", results.size());
  std::size_t done = 0;
  std::mutex counting;
  const auto test = [&](std::size_t k) {
    const std::size_t within = k % each;
    const std::uint64_t seed = kNewSeed + within / loads;
    const Inverted& soil = soils[k / each];
    const terrain::SoilFit& fit = soil.fit;
    results[k] = compressed(c, run.calibration, fit, soil.min_stress() * kInversionStress[within % loads], seed);
    density[k] = bulk_density_of(c, fit, seed);
    const std::lock_guard lock(counting);
    progress.update(++done, "");
  };
  for_each_on_host(results.size(), 1, test, run.threads);
  for (std::size_t i = 0; i < soils.size(); ++i) {
    const auto begin = results.begin() + std::ptrdiff_t(i * each);
    const auto s = terrain::triaxial_strength({begin, begin + std::ptrdiff_t(each)}, soils[i].soil.cohesion > 0);
    soils[i].friction_angle = s.peak_angle.degrees;
    soils[i].angle_error = s.peak_angle.error;
    soils[i].cohesion = s.peak_cohesion;
    soils[i].cohesion_error = s.peak_cohesion_error;
    for (std::size_t k = i * each; k < (i + 1) * each; ++k) soils[i].bulk_density += density[k] / double(each);
  }
}

CheckFigure inversion(const SoilValidation& run) {
  const Calibration c = terrain::read_calibration(run.calibration);
  std::vector<Inverted> soils = soils_of(c);
  measure(run, c, soils);
  CheckFigure f;
  f.name = "soils_inversion";
  f.csv =
      "soil,friction_angle_deg,measured_deg,standard_error_deg,cohesion_Pa,measured_Pa,standard_error_Pa,bulk_density,"
      "measured,relative_density,of_grains\n";
  f.plot.title = "Soils asked for, and measured on the grains that stand for them";
  f.plot.x_label = "friction angle asked for [deg]";
  f.plot.y_label = "friction angle measured [deg]";
  f.plot.lines = {{"equal", {15, 45}, {15, 45}, false}, {"soils", {}, {}, true}};
  double angle = 0, cohesion = 0, density = 0;
  for (const Inverted& s : soils) {
    f.csv += line("%s,%g,%.2f,%.2f,%g,%.0f,%.0f,%g,%.0f,%g,%.2f\n", s.name.c_str(), s.soil.friction_angle,
                  s.friction_angle, s.angle_error, s.soil.cohesion, s.cohesion, s.cohesion_error, s.soil.bulk_density,
                  s.bulk_density, s.soil.relative_density, s.fit.relative_density);
    f.plot.lines[1].add(s.soil.friction_angle, s.friction_angle);
    angle = std::max(angle, std::fabs(s.friction_angle - s.soil.friction_angle));
    if (s.soil.cohesion > 0) cohesion = std::max(cohesion, std::fabs(s.cohesion / s.soil.cohesion - 1));
    if (s.soil.bulk_density > 0) density = std::max(density, std::fabs(s.bulk_density / s.soil.bulk_density - 1));
  }
  f.check = {{"inversion_angle_deg", "inversion: largest error of a friction angle [deg]", 0, 1.5, angle},
             {"inversion_cohesion", "inversion: largest relative error of a cohesion", 0, 0.2, cohesion},
             {"inversion_density", "inversion: largest relative error of a bulk density", 0, 0.02, density},
             {"inversion_soils", "inversion: soils within reach, of five", 3, 5, double(soils.size())}};
  return f;
}

struct Named {
  const char* name;
  CheckFigure (*run)(const SoilValidation&);
};
constexpr Named kFigures[] = {{"shear", shear},   {"triaxial", triaxial},   {"plate", plate},        {"cone", cone},
                              {"repose", repose}, {"geostatic", geostatic}, {"inversion", inversion}};

}  // namespace

const std::vector<std::string>& soil_figures() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const Named& f : kFigures) all.emplace_back(f.name);
    return all;
  }();
  return names;
}

CheckFigure soil_figure(const std::string& name, const SoilValidation& run) {
  for (const Named& f : kFigures)
    if (name == f.name) return f.run(run);
  throw InputError("validate soils: \"" + name + "\" is no figure");
}

}  // namespace gonogo::lab
