// A folded bed: periodic across and narrower than the vehicle. Left and right wheels roll on the same grains, each in a
// lane of its own. A whole vehicle then needs a third of the ground under it.
//
// The period is two thirds of the track. Left and right lanes then lie half a bed apart, on both sides.
//
// Tilt, load transfer, drift and steering are those of the whole vehicle. Two things differ: ruts repeat every third of
// the track, and a belly as wide as the bed meets each grain only once.
#pragma once
#include "pipeline/campaign/trial/setup.h"

namespace gonogo::campaign {

/// Min gap between the sides of tyres in neighbouring lanes of a folded bed, in tyre widths. A wheel moves grains far
/// beside it: a tyre width from its side they move a fifth as far as those under it (docs/validation.md).
inline constexpr double kMinLaneGap = 1;

/// Two thirds of the track: the width of a folded bed whose lanes lie half a bed apart [m].
double folded_width(const vehicle::Vehicle& v);

/// Min gap between a left and a right tyre, or a tyre and its image, on a bed of this period [m].
double lane_gap(const vehicle::Vehicle& v, double width);

/// Makes the bed of `setup` a folded one of one tile across. Throws InputError as check_foldable() does.
void fold_bed(TrialSetup& setup);

/// Throws InputError for a quarter vehicle, which has one lane, and for tracks, whose hull would meet the belts'
/// images.
void check_foldable(const TrialSetup& setup);

/// Throws InputError, with a width that would do, when the lanes of a folded bed lie too close.
void check_lanes(const TrialSetup& setup);

}  // namespace gonogo::campaign
