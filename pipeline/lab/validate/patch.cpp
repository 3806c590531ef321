#include "pipeline/lab/validate/patch.h"

#include <algorithm>
#include <cmath>

namespace gonogo::lab {
namespace {

/// A quarter vehicle's bed as tiles a metre long; a whole vehicle's has tiles already.
campaign::TrialSetup patch_setup(const BedsRequest& r) {
  campaign::TrialSetup s = setup_of(r);
  if (!s.whole) {
    const double d = s.calibration.grain_diameter, wheel = s.rig.radius + s.rig.lug_height;
    s.bed_length = std::max(12 * d, 1.0);
    s.bed_width = std::max(8 * d, 2.5 * s.rig.width);
    s.moving_patch = true;
    s.tiles_along = int(std::ceil((2 * s.patch().reach + std::max(4 * d, wheel)) / s.bed_length));
  }
  s.tiles_along += s.tiles_along % 2;
  s.start = 0.5 * s.tiles_along * s.bed_length;
  fit_to_request(r, s);
  terrain::check_patch(s.patch(), s.calibration.grain_diameter);
  return s;
}

/// The same tiles, so many that the patch's reach stays on ground that nobody has been on.
campaign::TrialSetup fixed_setup(const campaign::TrialSetup& patch, double distance) {
  campaign::TrialSetup s = patch;
  s.moving_patch = false;
  s.tiles_along += int(std::ceil((distance + 0.5) / s.bed_length));
  return s;
}

}  // namespace

BedComparison compare_patch(const BedsRequest& r) {
  const campaign::TrialSetup patch = patch_setup(r);
  return compare_beds(r, {"patch", "moving patch", patch, {}},
                      {"fixed", "fixed bed", fixed_setup(patch, r.distance), {}});
}

}  // namespace gonogo::lab
