#include "terrain/bed/hard_layer.h"

namespace gonogo::terrain {

Packing on_hard_layer(const Packing& packing, double depth) {
  const double d = packing.spec.grain_diameter, top = packing.surface - depth;
  if (top < d / 2) return packing;
  Packing bed = packing;
  bed.grain.clear();
  bed.base.clear();
  const double lowest = -2 * d * (1 + packing.spec.size_spread);  // two grains thick: no grain above finds a hole
  const auto lowered = [&](Grain g) {
    g.position.z -= top;
    if (g.position.z >= 0)
      bed.grain.push_back(g);
    else if (g.position.z > lowest)
      for (const Grain& lobe : lobes_of(packing.spec.shape, {g})) bed.base.push_back(lobe);
  };
  for (const Grain& g : packing.grain) lowered(g);
  for (Grain g : packing.base) {  // glued already
    g.position.z -= top;
    if (g.position.z > lowest) bed.base.push_back(g);
  }
  bed.surface = depth;
  bed.spec.depth = depth;
  return bed;
}

}  // namespace gonogo::terrain
