// `gonogo soil test`: runs a virtual soil test at several loads, sizes or seeds and derives the numbers of soil
// mechanics from it.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/json/json.h"
#include "base/math/statistics.h"
#include "pipeline/report/figure/chart.h"
#include "terrain/soil_test/penetration.h"
#include "terrain/soil_test/strength_test.h"
#include "terrain/soil_test/test_run.h"

namespace gonogo::inspect {

struct SoilTestRequest {
  terrain::TestSoil soil;
  int seeds = 2;                                  // packings, from soil.seed on
  std::vector<double> stresses{5e3, 10e3, 20e3};  // shear: normal, triaxial: confining [Pa]
  std::optional<double> inertial_number;          // of shear and triaxial tests [-]; otherwise their own
  std::vector<double> plate_widths{4, 8};         // in grain diameters
  double cone_diameter = 4;                       // in grain diameters
  bool quick = false;                             // half the travel and smaller beds: for a first look
  std::optional<terrain::Numerics> numerics;      // of trials; otherwise each test has a pace of its own
  int threads = 1;
  sim::Backend device = sim::Backend::cpu;  // cuda: all runs in one batch
};

struct ReposeNumbers {
  terrain::Angle angle;
  double rest_speed = 0;  // [m/s]
};
struct ConeNumbers {
  double diameter = 0, depth = 0;  // of the base; to which the index is taken [m]
  MeanError index{};               // [Pa]
  terrain::LineFit gradient;       // [Pa/m]
  double bulk_density = 0;         // [kg/m^3]
};
struct TriaxialNumbers {
  terrain::TriaxialStrength strength;
  double solid_fraction = 0;  // before shear [-]
};

struct SoilTestOutcome {
  std::string test;
  SoilTestRequest request;
  // Those of the test that was run.
  std::optional<ReposeNumbers> repose{};
  std::optional<terrain::ShearStrength> shear{};
  std::optional<terrain::BekkerFit> plate{};
  std::optional<ConeNumbers> cone{};
  std::optional<TriaxialNumbers> triaxial{};
  double worst_residual = 0;  // of a step, rms [m/s]
  std::string csv{};          // all curves, one row per sample
  report::LinePlot plot{};
  terrain::TestScene scene{};  // of the last run, to be drawn

  void note_residual(double of_run) { worst_residual = of_run > worst_residual ? of_run : worst_residual; }
};

/// `test`: repose, shear, plate, cone or triaxial. Throws InputError for what cannot be tested.
SoilTestOutcome run_soil_test(const std::string& test, const SoilTestRequest& request);

Json as_json(const SoilTestOutcome& outcome);  // keys carry their units
std::string as_text(const SoilTestOutcome& outcome);
/// Writes <test>.json, .csv, .png (curves) and _bed.png (the grains) into a folder; the last two where the build has
/// pictures.
void write_soil_test(const std::filesystem::path& folder, const SoilTestOutcome& outcome, int threads);

/// Results of all plates, the widths of one seed after those of another. `scene`: of the last one; may be null. Throws
/// InputError for fewer than two widths.
std::vector<terrain::PlateResult> run_plates(const SoilTestRequest& r, terrain::TestScene* scene);
/// Results of all shear tests: for each stress, one per seed.
std::vector<terrain::ShearResult> run_shear(const SoilTestRequest& r, terrain::TestScene* scene);

}  // namespace gonogo::inspect
