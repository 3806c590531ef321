#include "pipeline/map/soil_grids/texture_mixture.h"

#include <algorithm>

#include "terrain/soil/texture.h"
#include "terrain/soil/texture_triangle.h"

namespace gonogo::map {
namespace {

/// Quantiles of the standard normal distribution at 0.1, 0.3, 0.5, 0.7, 0.9.
constexpr std::array<double, 5> kNormal = {-1.28155, -0.52440, 0, 0.52440, 1.28155};
constexpr int kPoints = 25;

std::size_t code_of(double sand, double clay) {
  sand = std::clamp(sand, 0.0, 100.0);
  clay = std::clamp(clay, 0.0, 100.0);
  const double sum = std::max(100.0, sand + clay);
  sand *= 100 / sum;
  clay *= 100 / sum;
  const auto& names = terrain::usda_texture_codes();
  const std::string name = terrain::usda_texture(sand, std::max(0.0, 100 - sand - clay), clay);
  return std::size_t(std::find(names.begin(), names.end(), name) - names.begin());
}

}  // namespace

TextureMixture texture_mixture(const TextureShares& s, int parts) {
  std::array<int, 12> count{};
  for (const double a : kNormal)
    for (const double b : kNormal) ++count[code_of(s.sand + a * s.sand_error, s.clay + b * s.clay_error)];
  TextureMixture mixture{};
  std::array<int, 12> rest{};
  int given = 0;
  for (std::size_t t = 0; t < count.size(); ++t) {
    mixture[t] = std::uint8_t(count[t] * parts / kPoints);
    rest[t] = count[t] * parts % kPoints;
    given += mixture[t];
  }
  for (; given < parts; ++given) {
    const auto largest = std::max_element(rest.begin(), rest.end());
    ++mixture[std::size_t(largest - rest.begin())];
    *largest = -1;
  }
  return mixture;
}

}  // namespace gonogo::map
