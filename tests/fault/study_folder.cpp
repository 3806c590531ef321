#include "tests/fault/study_folder.h"

#include <cmath>
#include <cstdlib>

#include "base/files/file.h"
#include "base/units.h"

namespace gonogo {
namespace fs = std::filesystem;
namespace {

constexpr int kColumns = 24, kRows = 40;
constexpr double kCell = 10;               // [m]
constexpr double kSteepestDegrees = 35.0;  // at the northern edge

/// ESRI ASCII grid: rows from north to south. The slope grows in proportion to the row's distance from the south edge.
std::string ramp() {
  std::string text = "ncols " + std::to_string(kColumns) + "\nnrows " + std::to_string(kRows) +
                     "\nxllcorner 730000\nyllcorner 4368000\ncellsize 10\nNODATA_value -9999\n";
  for (int row = 0; row < kRows; ++row) {
    double height = 2000;
    for (int below = kRows - 1; below > row; --below) {
      const double share = double(kRows - 1 - below) / (kRows - 1);
      height += kCell * std::tan(share * kSteepestDegrees * kDegree);
    }
    for (int column = 0; column < kColumns; ++column) text += std::to_string(height) + " ";
    text += "\n";
  }
  return text;
}

Json raster(const char* role, const char* file) {
  Json entry = Json::object();
  entry["role"] = role;
  entry["file"] = file;
  entry["source"] = "made by tests/fault/study_folder.cpp";
  entry["licence"] = "as the tests";
  return entry;
}

/// Few, short and coarse trials, whose checks always pass: these tests are not about physics.
constexpr const char* kStudy = R"({
  "study": "fault", "seed": 7, "vehicle": "vehicle.json", "region": "region.json",
  "soil": { "calibration": "calibration.json" },
  "trial": {
    "bed": { "length_m": 2, "width_m": 0.7, "packing_seeds": 1, "settle_s": 0.05 },
    "drive": { "park_s": 0.05, "ramp_s": 0.1, "run_in_m": 0.05, "test_distance_m": 0.2, "minimum_drive_s": 0.1,
               "time_limit_s": 0.6 },
    "numerics": { "step_s": 2e-3, "substeps": 1, "iterations": 200, "tolerance_m_per_s": 0.01, "target": "ccp" },
    "thresholds": { "immobile_s": 0.2, "residual_m_per_s": 10, "energy_error": 10 }
  },
  "design": {
    "method": "sobol", "points": 6, "replicate_every": 0,
    "ranges": { "slope_along": [0, 35], "friction_angle": [25, 35] },
    "fixed": { "slope_across": 0, "cohesion": 0, "relative_density": 0.5, "payload": 0, "tyre_friction": 0.8,
               "bed_depth": 0.3, "commanded_speed": 1 }
  },
  "learning": { "hidden": 2, "epochs": 20, "chains": 8, "folds": 2 },
  "map": { "draws": 4 }
})";

/// Numbers chosen, not measured: enough for trials to run.
constexpr const char* kCalibration = R"({
  "schema": "gonogo/calibration/1", "grain_diameter_m": 0.12,
  "packing": [ { "settle_friction": 0.5, "solid_fraction": 0.55, "relative_density": 0 },
               { "settle_friction": 0.1, "solid_fraction": 0.62, "relative_density": 1 } ],
  "contact": [ { "friction": 0.2, "rolling_friction": 0, "friction_angle_deg": 20,
                 "friction_angle_error_deg": 1, "cohesion_gain": 1, "cohesion_gain_error": 0.1 },
               { "friction": 0.9, "rolling_friction": 0.2, "friction_angle_deg": 38,
                 "friction_angle_error_deg": 1, "cohesion_gain": 1, "cohesion_gain_error": 0.1 } ],
  "cohesion_gain": 1, "cohesion_gain_error": 0.1,
  "provenance": { "note": "made for tests" }
})";

constexpr const char* kRegionValues = R"({
  "friction_angle": { "fixed": 30, "source": "middle of the design" },
  "cohesion": { "fixed": 0, "source": "design" }, "relative_density": { "fixed": 0.5, "source": "design" },
  "payload": { "fixed": 0, "source": "design" }, "tyre_friction": { "fixed": 0.8, "source": "design" },
  "bed_depth": { "fixed": 0.3, "source": "design" }, "commanded_speed": { "fixed": 1, "source": "design" }
})";

}  // namespace

const char* const kProjectedWkt =
    R"(PROJCS["WGS_1984_UTM_Zone_10N",GEOGCS["GCS_WGS_1984",DATUM["D_WGS_1984",SPHEROID["WGS_1984",6378137.0,298.257223563]],)"
    R"(PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],)"
    R"(PARAMETER["False_Easting",500000.0],PARAMETER["False_Northing",0.0],PARAMETER["Central_Meridian",-123.0],)"
    R"(PARAMETER["Scale_Factor",0.9996],PARAMETER["Latitude_Of_Origin",0.0],UNIT["Meter",1.0]])";
const char* const kGeographicWkt =
    R"(GEOGCS["GCS_WGS_1984",DATUM["D_WGS_1984",SPHEROID["WGS_1984",6378137.0,298.257223563]],)"
    R"(PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]])";

StudyFolder::StudyFolder() {
  ::setenv("GONOGO_CACHE", path("cache").c_str(), 1);  // settled beds of these tests go away with the folder
  study = Json::parse(kStudy, "study");
  region["schema"] = "gonogo/region/1";
  region["region"] = "ramp";
  region["rasters"] = Json::Array{raster("elevation", "elevation.asc")};
  region["values"] = Json::parse(kRegionValues, "values");
  write();
}

void StudyFolder::write() const {
  write_file_atomically(path("study.json"), study.dump(2) + "\n");
  write_file_atomically(path("calibration.json"), kCalibration);
  write_file_atomically(path("vehicle.json"), read_file(GONOGO_SOURCE_DIR "/configs/vehicles/hmmwv_quarter.json"));
  write_file_atomically(path("region.json"), region.dump(2) + "\n");
  write_file_atomically(path("elevation.asc"), ramp());
  write_file_atomically(path("elevation.prj"), kProjectedWkt);
}

void StudyFolder::make_readable_for_all() const { fs::permissions(folder_.path(), fs::perms{0755}); }

}  // namespace gonogo
