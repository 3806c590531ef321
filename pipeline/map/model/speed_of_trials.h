// What trials tell about the top speed of their vehicle.
#pragma once
#include <optional>

#include "pipeline/map/evaluate/top_speed.h"
#include "pipeline/map/model/trained_model.h"

namespace gonogo::map {

/// Fits resistance, slip and sinkage to the trials that passed. The driveline is that of `whole`, which a quarter
/// vehicle stands for. Trials on level ground or uphill measure the resistance: downhill
/// the vehicle may roll against its brakes, whose torque is not measured. Nothing if there is none.
std::optional<SpeedModel> speed_of_trials(const campaign::Dataset& dataset, const TrialVehicle& driven,
                                          const vehicle::Vehicle& whole);

}  // namespace gonogo::map
