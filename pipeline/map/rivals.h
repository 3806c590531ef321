// Semi-empirical relations as go/no-go forecasts of vehicles of a family: what a model of their trials has to beat.
// Each says the largest pull of the vehicle over its weight. Less the tangent of the slope it is a margin, and go is
// forecast where that is positive.
//
//   cone_index   Brixius 1987 (traction.h), and no-go below the vehicle cone index of one pass (mobility_index.h), as
//                the NATO Reference Mobility Model holds the two together
//   drove_sand, drove_clay   fits of Mason et al. 2018 and Detwiller et al. 2018 to the DROVE database (traction.h)
//   bekker_wong  Wong & Reece 1967 (bekker_wong.h) with the dry sand of the Land Locomotion Laboratory (Wong, Theory
//                of Ground Vehicles, table of terrain values) and the trial's own friction angle and cohesion
//
// The cone index is that of the trial's friction angle and cohesion (terrain/soil/soil.h). Axles carry their share of
// the weight on the slope. No pull exceeds what force and power give at the commanded speed.
#pragma once
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace gonogo::map {

/// Names, in the order of rival_margins().
const std::vector<std::string>& rival_names();

/// Margins at a point of the family's trials: variables of the contract, wheels of this diameter [m] on the Earth.
std::vector<double> rival_margins(std::span<const double> point, double diameter);

}  // namespace gonogo::map
