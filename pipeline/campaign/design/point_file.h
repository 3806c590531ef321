// Design points from text files.
#pragma once
#include <filesystem>
#include <vector>

#include "pipeline/campaign/trial/record.h"

namespace gonogo::campaign {

/// Comma-separated values with a header that names variables of the contract, in any order, then one point per line. A
/// column "proposal_density" is needed where the points do not come from a uniform design. `fixed` [variable count]
/// holds the values of the variables without a column. Throws InputError with file and line.
std::vector<DesignPoint> read_point_csv(const std::filesystem::path& file, const std::vector<double>& fixed);

/// The original study's input (R. Serban's go_nogo programs, projectchrono fork, commit 6e9a73d694, 2017): one run per
/// line, "slope [deg]  particle radius [mm]  particle density [kg/m^3]  friction [-]  cohesion [kPa]".
///   slope -> slope_along;  friction -> friction_angle = atan(friction) (Coulomb);  cohesion -> cohesion *
///   cohesion_scale
/// Its cohesion is a contact stress, not a soil's, hence the scale. Radius and density belong to the grains of the
/// study's calibration here: they must be the same on every line.
std::vector<DesignPoint> read_original_points(const std::filesystem::path& file, const std::vector<double>& fixed,
                                              double cohesion_scale);

}  // namespace gonogo::campaign
