// A calibration read by the friction angle that a soil shows at its peak, at its own density: what laboratories mean by
// the friction angle of sand denser than loose (GRC-1 has 30 to 44 degrees from loose to dense, Oravec 2010).
#pragma once
#include "terrain/soil/calibration.h"

namespace gonogo::terrain {

/// The same table with, as friction angles, the peaks in the packing nearest to a relative density; never falling along
/// the line, as stronger contacts make no weaker soil. Throws InputError for a table without responses.
Calibration at_peak(Calibration calibration, double relative_density);

}  // namespace gonogo::terrain
