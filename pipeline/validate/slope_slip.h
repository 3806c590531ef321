// The MGRU3 single wheel on GRC-1: slip over slope, measured at NASA Glenn's SLOPE laboratory, against trials on a bed
// that has the soil's friction angle, cohesion and bulk density by a calibration. Nothing is tuned on the slips.
// Measured slips and those of a published simulation by discrete elements, both digitised, from uwsbel/chrono-wisc,
// feature/fsi-CRMAcc: python_scripts/viper_singleWheel_multidir_plotting.py.
#pragma once
#include <filesystem>
#include <vector>

#include "pipeline/validate/soil_figure.h"
#include "terrain/soil/table_numerics.h"

namespace gonogo::pipeline {

struct SlopeSlipRun {
  std::filesystem::path calibration;            // of the grains
  double grain = 0;                             // diameter instead of the table's, if any: nothing that a
                                                // triaxial test says depends on it [m]
  int seeds = 2;                                // beds per slope
  int threads = 1;                              // trials at a time
  bool gpu = false;                             // all trials as one batch
  terrain::AskedNumerics numerics;              // in the place of the table's
  double depth = 0.2, length = 2, width = 0.7;  // of the bed [m]
  double time = 8;                              // driven; slip is that of the last half [s]
  // Of grains on the wheel. No experiment tells: 0.8 is that of the published simulation (DEM-Engine, WheelSlopeSlip),
  // 0.4 that of Project Chrono's VIPER.
  double wheel_friction = 0.8;
};

struct SlopeSlip {
  double slope = 0;                    // [deg]
  double measured = 0, published = 0;  // slip of the experiment; of the published simulation [-]
  double slip = 0, slip_error = 0;     // mean and standard error over the beds [-]
  double sinkage = 0;                  // [m]
  int trials = 0;                      // that ended as they should
  std::vector<double> over_time;       // [second of driving] slip, mean over the beds
};

/// The published simulation as if it were a run of ours.
std::vector<SlopeSlip> published_slope_slips();

std::vector<SlopeSlip> run_slope_slip(const SlopeSlipRun& run);

/// Root-mean-square difference between slips and the experiment's, up to a slope [deg].
double rms_slip_error(const std::vector<SlopeSlip>& points, double steepest = 90);

SoilFigure slope_slip_figure(const SlopeSlipRun& run, const std::vector<SlopeSlip>& points);

}  // namespace gonogo::pipeline
