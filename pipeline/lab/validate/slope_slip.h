// MGRU3 on GRC-1: slip over slope. Compared: tests at NASA Glenn's SLOPE laboratory with trials on a calibrated bed
// that has the soil's friction angle, cohesion and bulk density. Nothing is tuned on the slips.
//
// MGRU3 is a rover of four wheels. The tests drove it on a tilting bed in 2021 and again in 2022. Both are digitised in
// sjtumsd/crm_sim_nasa_exp_scripts, demos/viper_real_slope/figure7b.py (arXiv 2405.11001), beside a simulated rover of
// 88 kg.
//
// Published simulations also compare one wheel under its share of the weight with the tests of 2021. One, by discrete
// elements, is uwsbel/chrono-wisc (feature/fsi-CRMAcc), python_scripts/viper_singleWheel_multidir_plotting.py. Wheel
// and rover can both be run here.
#pragma once
#include <vector>

#include "pipeline/lab/validate/simulant.h"
#include "pipeline/lab/validate/soil_figure.h"

namespace gonogo::lab {

struct SlopeSlip {
  double slope = 0;                    // [deg]
  double measured = 0, published = 0;  // slip of the experiment; of the published simulation [-]
  double slip = 0, slip_error = 0;     // mean and standard error over the beds [-]
  double sinkage = 0;                  // [m]
  int trials = 0;                      // that ended as they should
  std::vector<double> over_time = {};  // [second of driving] slip, mean over the beds
};

/// The published simulation in the form of a run.
std::vector<SlopeSlip> published_slope_slips();
/// The same of the tests of 2022, interpolated to the slopes of 2021: how far the experiment repeats itself.
std::vector<SlopeSlip> repeated_slope_slips();

std::vector<SlopeSlip> run_slope_slip(const SimulantRun& run);

/// Root-mean-square difference between slips and the experiment's, up to a slope [deg].
double rms_slip_error(const std::vector<SlopeSlip>& points, double steepest = 90);

SoilFigure slope_slip_figure(const SimulantRun& run, const std::vector<SlopeSlip>& points);

}  // namespace gonogo::lab
