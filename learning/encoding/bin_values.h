// Values inside a bin.
#pragma once
#include "learning/encoding/encoder.h"

namespace gonogo::learning {

/// The value at the share u, in [0, 1), of a bin's width [unit]. Categories have no width.
inline double value_inside(const Encoder& encoder, int bin, double u) {
  return encoder.categories().empty() ? encoder.value(bin) + (2 * u - 1) * encoder.resolution(bin) : encoder.value(bin);
}

}  // namespace gonogo::learning
