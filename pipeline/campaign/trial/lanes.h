// A folded bed: periodic across and narrower than the vehicle. Left and right wheels roll on the same few grains, each
// in a lane of its own, so that a whole vehicle needs a third of the ground that lies under it.
//
// With a period of two thirds of the track, the lane of the right wheels is where the left ones would have their image
// a track and a half further: half a bed away from it on both sides. Tilt, load transfer, drift and steering are those
// of the whole vehicle; what changes is that the ruts repeat every third of the track, and that a belly as wide as the
// bed meets each grain once only.
#pragma once
#include "pipeline/campaign/trial/setup.h"

namespace gonogo::campaign {

/// Ground between the sides of tyres in neighbouring lanes, in tyre widths, that a folded bed must leave. A wheel moves
/// grains far beside it: a tyre width from its side they move a fifth of the way of those under it
/// (docs/validation.md).
inline constexpr double kMinLaneGap = 1;

/// Two thirds of the track: the width of a folded bed whose lanes lie half a bed apart [m].
double folded_width(const vehicle::Vehicle& v);

/// Least ground between the sides of a left and a right tyre, or of a tyre and its image, on a bed of this period [m].
double lane_gap(const vehicle::Vehicle& v, double width);

/// Makes the bed of `setup` a folded one of one tile across. Throws InputError as check_foldable() does.
void fold_bed(TrialSetup& setup);

/// Throws InputError for a quarter vehicle, which has one lane, and for tracks, whose hull would meet the belts'
/// images.
void check_foldable(const TrialSetup& setup);

/// Throws InputError when the lanes of a folded bed lie too close, saying which width would do.
void check_lanes(const TrialSetup& setup);

}  // namespace gonogo::campaign
