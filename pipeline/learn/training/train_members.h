// Models that might as well have come of the trials: the spread of what they say is how much the trials leave open.
//
// Bayesian bootstrap (Rubin 1981, Annals of Statistics 9, 130-134): every group of trials at one point gets a weight
// drawn from the exponential distribution of mean 1, and the machine is trained again, for as many epochs and with the
// same calibration as the model itself.
#pragma once
#include <filesystem>
#include <vector>

#include "pipeline/learn/training/train_model.h"

namespace gonogo::learn {

/// Trains `count` members beside the model of `request`, which must have been trained on the same dataset:
/// <model's stem>.member1.h5, ... Returns their names. Same dataset, seed and settings: same bytes.
std::vector<std::filesystem::path> train_members(const TrainRequest& request, int count);

}  // namespace gonogo::learn
