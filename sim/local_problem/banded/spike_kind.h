// The two kinds of SPIKE; spike.h explains them.
#pragma once

namespace gonogo::sim {

enum class SpikeKind { full, truncated };

}  // namespace gonogo::sim
