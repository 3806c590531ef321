// A vehicle on a bed narrower than itself. The simulation folds its bodies into the bed's period; pictures show them
// where joints hold them.
#pragma once
#include <vector>

#include "sim/io/capture.h"

namespace gonogo::report {

struct Unfolded {
  std::vector<sim::BodyState> body;  // [body], those that joints connect with the focus beside it
  std::vector<bool> beside;          // [body] connected with the focus, or the focus itself
  int copies = 1;                    // of the bed side by side that carry all of them, an odd number
};

/// `focus` may be -1: then nothing is unfolded.
Unfolded unfolded(const sim::SceneWorld& world, const sim::Capture& frame, sim::BodyIndex focus);

}  // namespace gonogo::report
