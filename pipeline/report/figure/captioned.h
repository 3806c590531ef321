// A rendered picture with what a viewer needs to read it: title, badge, facts, colour bar. Without cairo every function
// of this folder that writes a figure does nothing.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"
#include "pipeline/report/picture/render.h"

namespace gonogo::report {

/// True when the build has cairo (-DGONOGO_PICTURES=ON).
bool pictures_available();

/// For what a user asked for by name: throws InputError when this build cannot draw. `options`: what was asked for,
/// "--picture, --video".
inline void require_pictures(const std::string& options) {
  if (!pictures_available())
    throw InputError("this build has no pictures (" + options + "); configure with -DGONOGO_PICTURES=ON");
}

struct Fact {
  std::string label, value;  // "slip", "0.18"
};

/// A word on a coloured field in the upper right corner.
struct Badge {
  std::string text;    // empty: no badge
  std::string colour;  // "#rrggbb"
};

struct Caption {
  std::string title = {};
  Badge badge = {};
  std::vector<Fact> facts = {};            // along the foot, left to right
  std::string bar_label = {};              // "grain speed [m/s]"
  double bar_low = 0, bar_high = 1;        // ends of the bar, in the label's unit
  std::vector<std::uint8_t> bar_rgb = {};  // [steps][3] sRGB, from low to high; empty: no bar
};

/// Writes the picture with its caption as PNG, whole or not at all. Does nothing in a build without pictures. Throws
/// DeviceError when the file cannot be written.
void write_captioned(const std::filesystem::path& path, const Image& image, const Caption& caption);

}  // namespace gonogo::report
