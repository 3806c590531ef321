// A rendered trial with what one needs to read it: title, verdict, numbers, colour bar.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/report/picture/image.h"

namespace gonogo::report {

struct TrialCaption {
  std::string title;
  std::string verdict, verdict_colour;  // "" while the trial runs; "#rrggbb"
  struct Fact {
    std::string label, value;  // "slip", "0.18"
  };
  std::vector<Fact> facts;            // along the foot, left to right
  std::string bar_label;              // "grain speed [m/s]"
  double bar_low = 0, bar_high = 1;   // ends of the bar
  std::vector<std::uint8_t> bar_rgb;  // [steps][3] sRGB, from low to high
};

/// Shares of the picture that the caption takes; the model should keep out of them.
inline constexpr double kCaptionHead = 0.10, kCaptionFoot = 0.12, kCaptionSide = 0.11;

/// Writes the picture with its caption as PNG, whole or not at all.
void write_trial_figure(const std::filesystem::path& path, const Image& image, const TrialCaption& caption);

}  // namespace gonogo::report
