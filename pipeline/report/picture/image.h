// A picture in memory.
#pragma once
#include <cstdint>
#include <vector>

namespace gonogo::report {

struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgb;  // [height][width][3], sRGB, top row first
};

}  // namespace gonogo::report
