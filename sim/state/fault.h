// The first fault of a world: of the step that raised the first flag, the body with the lowest index. The order of the
// threads does not matter.
#pragma once
#include "base/for_each.h"

namespace gonogo::sim {

/// Bits of the flag word of a world.
enum StepFlag : Index {
  flag_not_finite = 1,   // a velocity or position is NaN or infinite: smaller step or more iterations
  flag_too_fast = 2,     // a body moves more than a bin in a step, see StepSettings::max_slowed: smaller step
  flag_left_domain = 4,  // a body fell out of the domain: deeper domain or rougher base
};

struct Fault {
  Index flags = 0;      // of this body in this step; 0: nothing has gone wrong
  Index step = 0;       // counted from 1
  BodyIndex body = -1;  // in its world
};

/// Smaller is earlier, then lower in index.
using PackedFault = std::uint64_t;
inline constexpr PackedFault kNoFault = ~PackedFault(0);

GONOGO_HD inline PackedFault packed(const Fault& f) {
  if (f.flags == 0) return kNoFault;
  return PackedFault(std::uint32_t(f.step)) << 34 | PackedFault(std::uint32_t(f.body)) << 3 | PackedFault(f.flags);
}

GONOGO_HD inline Fault unpacked(PackedFault p) {
  if (p == kNoFault) return {};
  return {Index(p & 7), Index(p >> 34), BodyIndex(p >> 3 & 0x7FFFFFFF)};
}

}  // namespace gonogo::sim
