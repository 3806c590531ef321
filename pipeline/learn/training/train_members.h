// Trains bootstrap members of a model. The spread of their answers measures the uncertainty that the trials leave.
//
// Bayesian bootstrap (Rubin 1981, Annals of Statistics 9, 130-134): every group of trials at one point gets a weight
// drawn from the exponential distribution of mean 1. The machine is then trained again, with the same number of epochs
// and the same calibration as the model.
#pragma once
#include <filesystem>
#include <vector>

#include "pipeline/learn/training/train_model.h"

namespace gonogo::learn {

/// Trains `count` members and writes <model's stem>.member1.h5, ... beside the model. The model must have been trained
/// with the same request. Returns the paths. After an interruption the same calls take finished members
/// from disk. The same dataset, seed and settings give the same bytes.
std::vector<std::filesystem::path> train_members(const TrainRequest& request, int count);

}  // namespace gonogo::learn
