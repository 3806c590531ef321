// One wheel of MGRU3 on GRC-3, towed at given slips. Compared: the slope that its drawbar pull would climb, atan(pull /
// load), with tests of a single wheel at NASA Glenn (TREC rig, nominal tests). Nothing is tuned on them.
//
// Measured points, digitised: sjtumsd/crm_sim_nasa_exp_scripts, demos/single_wheel_vv_mode/slope_slip_wheel_vv_mode.py
// (arXiv 2405.11001). That work compares a wheel of 17.5 kg on three states of the simulant with them.
#pragma once
#include <vector>

#include "pipeline/lab/validate/simulant.h"
#include "pipeline/lab/validate/soil_figure.h"

namespace gonogo::lab {

struct GivenSlip {
  double slip = 0;                                      // over the grousers [-]
  double measured = 0, lowest = 0, highest = 0;         // traction slope of the tests: mean and span [deg]
  double traction_slope = 0, traction_slope_error = 0;  // mean and standard error over the beds [deg]
  double sinkage = 0;                                   // [m]
  int trials = 0;                                       // that ended as they should
};

/// The tests' means in the form of a run.
std::vector<GivenSlip> measured_traction();

std::vector<GivenSlip> run_given_slips(const SimulantRun& run);

/// Root-mean-square difference between traction slopes and the tests' means [deg].
double rms_traction_error(const std::vector<GivenSlip>& points);

SoilFigure given_slip_figure(const SimulantRun& run, const std::vector<GivenSlip>& points);

}  // namespace gonogo::lab
