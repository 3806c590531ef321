#include "pipeline/campaign/trial/lanes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "base/format.h"
#include "vehicle/model/engine_vehicle.h"

namespace gonogo::campaign {
namespace {

/// Largest distance of the middles of a left and a right tyre [m].
double track_of(const vehicle::Vehicle& v) {
  double track = 0;
  for (const vehicle::RunningPart& p : vehicle::running_parts(v))
    if (p.reach > 0) track = std::max(track, 2 * std::fabs(p.centre.y));
  return track;
}

double widest_tyre(const vehicle::Vehicle& v) {
  double width = 0;
  for (const vehicle::RunningPart& p : vehicle::running_parts(v)) width = std::max(width, p.width);
  return width;
}

}  // namespace

double folded_width(const vehicle::Vehicle& v) { return 2 * track_of(v) / 3; }

double lane_gap(const vehicle::Vehicle& v, double width) {
  double smallest = std::numeric_limits<double>::infinity();
  const auto parts = vehicle::running_parts(v);
  for (const vehicle::RunningPart& a : parts) {
    if (!(a.reach > 0)) continue;
    smallest = std::min(smallest, width - a.width);
    for (const vehicle::RunningPart& b : parts)
      if (b.reach > 0 && a.centre.y > 0 && b.centre.y < 0)
        smallest =
            std::min(smallest, std::fabs(std::remainder(a.centre.y - b.centre.y, width)) - (a.width + b.width) / 2);
  }
  return smallest;
}

void check_foldable(const TrialSetup& s) {
  if (!s.whole)
    throw InputError(s.vehicle_file.string() +
                     ": a folded bed has lanes for left and right wheels, and this is a quarter vehicle; leave "
                     "trial.bed.folded out, or name a whole vehicle");
  if (!s.whole->track.empty())
    throw InputError(s.vehicle_file.string() +
                     ": a folded bed is for wheels; on it, the hull of a tracked vehicle would meet the images of its "
                     "belts; leave trial.bed.folded out");
}

void check_lanes(const TrialSetup& s) {
  const double width = s.tiles_across * s.bed_width, needed = kMinLaneGap * widest_tyre(*s.whole);
  const double gap = lane_gap(*s.whole, width);
  if (gap >= needed) return;
  throw InputError("on a folded bed of " + number_text(width, 4) + " m there are " +
                   number_text(std::max(0.0, gap), 4) + " m between the tyres of neighbouring lanes; at least " +
                   number_text(needed, 4) +
                   " m are needed, so that no tyre runs in another's rut; leave trial.bed.width_m out, which gives " +
                   number_text(folded_width(*s.whole), 4) + " m, or trial.bed.folded");
}

void fold_bed(TrialSetup& s) {
  check_foldable(s);
  s.folded = true;
  s.bed_width = folded_width(*s.whole);
  s.tiles_across = 1;
  check_lanes(s);
}

}  // namespace gonogo::campaign
