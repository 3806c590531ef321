// A world for places of a batch that nobody has.
#pragma once
#include "sim/scene/scene.h"

namespace gonogo::sim {

/// A body that does not move. Stepping it costs next to nothing.
inline SceneWorld vacant_world() {
  SceneWorld w;
  w.add_body({}, fixed_body());
  return w;
}

}  // namespace gonogo::sim
