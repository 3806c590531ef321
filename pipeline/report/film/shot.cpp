#include "pipeline/report/film/shot.h"

#include "pipeline/report/figure/pictures.h"
#include "pipeline/report/picture/render.h"

namespace gonogo::report {

void add_bar(Caption& caption, const std::string& label, double low, double high) {
  caption.bar_label = label;
  caption.bar_low = low;
  caption.bar_high = high;
  constexpr int steps = 128;
  for (int k = 0; k < steps; ++k) {
    const Light light = bar_colour((k + 0.5) / steps);
    for (const Real channel : {light.x, light.y, light.z}) caption.bar_rgb.push_back(srgb(channel));
  }
}

void write_shot(const ShotFile& file, const Model& model, const Camera& camera, const Caption& caption) {
  if (!pictures_available()) return;
  write_captioned(file.path, render(model, camera, file.width, file.height, file.threads), caption);
}

}  // namespace gonogo::report
