// Trials of vehicles that a family answers for, each driven by itself, calibrate the family's model. A family's trials
// are simpler than a vehicle's own: a motor in every wheel, grains that are coarse for large wheels, hardly any rigid
// wheel. What that does to the odds of passing is measured where both are known, and taken off by one number.
#pragma once
#include <string>
#include <vector>

#include "learning/encoding/layout.h"
#include "learning/model/weights.h"
#include "learning/training.h"
#include "pipeline/outcome/answer/predictor.h"

namespace gonogo::outcome {

/// Valid trials of one vehicle as points of its family's: variables of the contract.
struct VehicleTrials {
  std::string hash, vehicle;  // of the dataset's file; the vehicle's name
  learning::TrainingTable table;
};

/// The shift of the model's log odds of passing that gives the trials the least log loss, every vehicle counting alike
/// [nat]. Negative where the model leans to go. 0 without vehicles.
double fitted_shift(const Predictor& model, const std::vector<VehicleTrials>& vehicles);

/// Shifts the log odds of passing by `shift` at every point: outcomes that pass get the bias shift / power, where
/// `power` sharpens the machine's probabilities afterwards (learning::Model::calibration_power).
void shift_odds(const learning::VisibleLayout& layout, double shift, double power, learning::RbmWeights& weights);

}  // namespace gonogo::outcome
