#include "terrain/soil/peak_table.h"

#include <algorithm>

#include "base/error.h"

namespace gonogo::terrain {

Calibration at_peak(Calibration c, double relative_density) {
  if (c.response.empty()) throw InputError("soil: this calibration has no peak friction angles; make it anew");
  const std::size_t packing = packing_level(c, relative_density);
  double largest = 0;
  for (std::size_t k = 0; k < c.contact.size(); ++k) {
    largest = std::max(largest, c.response[k * c.packing.size() + packing].peak_friction_angle);
    c.contact[k].friction_angle = largest;
  }
  return c;
}

}  // namespace gonogo::terrain
