// The undisturbed surface, where sinkage is zero.
#pragma once
#include "terrain/bed/bed.h"

namespace gonogo::campaign {

/// Height of the axle of an unloaded wheel that is lowered onto the undisturbed grains until it touches one [m]: mean
/// over the places [from, from + way] along x in the lane at y. `reach`: from the axle to the tips of its lugs.
///
/// Sinkage of plates and wheels is zero at the first touch (bevameter tests; Wong, Theory of Ground Vehicles, 2.4). A
/// wheel rests on the highest grains under it. The mean top of the bed includes the gaps between grains and lies up to
/// half a grain lower. Counted from there, a wheel that has not sunk would have a negative sinkage. `yaw`: of the wheel
/// from x towards y [rad].
double untouched_axle_height(const terrain::Packing& packing, double reach, double width, double y, double from,
                             double way, double yaw = 0);

}  // namespace gonogo::campaign
