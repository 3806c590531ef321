// `gonogo soil test`: runs a virtual soil test at several loads, sizes or seeds and derives the numbers of soil
// mechanics from it.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/json/json.h"
#include "pipeline/report/figure/line_plot.h"
#include "terrain/soil_test/test_run.h"

namespace gonogo::lab {

struct SoilTestRequest {
  terrain::TestSoil soil;
  int seeds = 2;                                  // packings, from soil.seed on
  std::vector<double> stresses{5e3, 10e3, 20e3};  // shear: normal, triaxial: confining [Pa]
  std::vector<double> plate_widths{4, 8};         // in grain diameters
  double cone_diameter = 4;                       // in grain diameters
  bool quick = false;                             // half the travel and smaller beds: for a first look
  std::optional<terrain::Numerics> numerics;      // of trials; otherwise each test has a pace of its own
  int threads = 1;
};

struct SoilTestOutcome {
  Json json;         // derived numbers; keys carry their units
  std::string text;  // the same for people
  std::string csv;   // all curves, one row per sample
  report::LinePlot plot;
  terrain::TestScene scene;  // of the last run, to be drawn
};

/// `test`: repose, shear, plate, cone or triaxial. Throws InputError for what cannot be tested.
SoilTestOutcome run_soil_test(const std::string& test, const SoilTestRequest& request);

/// Writes <test>.json, .csv, .png (curves) and _bed.png (the grains) into a folder; the last two where the build has
/// pictures.
void write_soil_test(const std::filesystem::path& folder, const std::string& test, const SoilTestOutcome& outcome,
                     int threads);

}  // namespace gonogo::lab
