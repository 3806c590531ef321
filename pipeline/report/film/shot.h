// One picture of a model of a scene, with its caption, as PNG.
#pragma once
#include <filesystem>
#include <string>

#include "pipeline/report/figure/captioned.h"
#include "pipeline/report/picture/camera.h"

namespace gonogo::report {

/// Margins that keep a model out of its caption and colour bar.
inline constexpr Margins kCaptionMargins = {.left = 0.03, .right = 0.12, .top = 0.12, .bottom = 0.15};

/// Gives the caption a bar in the colours of model_of() from `low` to `high`, in the label's unit.
void add_bar(Caption& caption, const std::string& label, double low, double high);

/// Where and how large a picture is drawn.
struct ShotFile {
  std::filesystem::path path;
  int width = 1280, height = 720;  // [pixel]
  int threads = 1;                 // the same bytes for any number
};

/// Renders the model and writes it with its caption, whole or not at all. Does nothing in a build without pictures.
/// Throws DeviceError when the file cannot be written.
void write_shot(const ShotFile& file, const Model& model, const Camera& camera, const Caption& caption);

}  // namespace gonogo::report
