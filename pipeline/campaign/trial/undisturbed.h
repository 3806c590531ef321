// The undisturbed surface that sinkage is counted from.
#pragma once
#include "terrain/bed/bed.h"

namespace gonogo::campaign {

/// Of a wheel without load that is lowered onto the undisturbed grains until it touches one: height of its axle, in the
/// mean over the places [from, from + way] along x in the lane at y [m]. `reach`: from the axle to the tips of its
/// lugs.
///
/// Sinkage of plates and wheels is zero at the first touch (bevameter tests; Wong, Theory of Ground Vehicles, 2.4). A
/// wheel rests on the highest grains under it. The mean top of the bed, which counts the gaps between them too, lies up
/// to half a grain lower: wheels that have not sunk at all would be said to stand above the ground.
double untouched_axle_height(const terrain::Packing& packing, double reach, double width, double y, double from,
                             double way);

}  // namespace gonogo::campaign
