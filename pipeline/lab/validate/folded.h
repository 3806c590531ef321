// A folded bed (pipeline/campaign/trial/lanes.h) against three of it side by side. On the wide bed every wheel stands
// on the same grains, and left and right lanes lie a whole track apart. Also measured: how far from its lane a wheel
// moves grains.
#pragma once
#include "pipeline/lab/validate/two_beds.h"

namespace gonogo::lab {

struct FoldedReport {
  BedComparison beds;
  double lane_distance = 0;   // between the middles of neighbouring lanes on the folded bed [m]
  double tyre_width = 0;      // [m]
  double bin_width = 0;       // of the profile [m]
  std::vector<double> moved;  // by distance from the nearest lane's middle, on the wide bed: mean [m]
  /// Distance from a lane's middle beyond which grains move less than a tenth as far as those under the tyre [m].
  double rut_half_width = 0;
};

/// `width` of the folded bed [m]; 0: two thirds of the track. Throws InputError for one whose lanes lie too close.
FoldedReport compare_folded(const BedsRequest& request, double width = 0);

Json as_json(const FoldedReport& r);
std::string as_text(const FoldedReport& r);

}  // namespace gonogo::lab
