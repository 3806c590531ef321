// Correlated random numbers of one draw of a drive.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "base/json/config.h"
#include "base/normal.h"

namespace gonogo::map {

/// Standard normal field over the variables: correlation exp(-d^2 / 2), with d the distance in units of `likeness`
/// times the sampled ranges. Random Fourier features (Rahimi and Recht, NIPS 2007) with normal amplitudes, so that each
/// value is exactly normal. Variables that were held fixed, or are NaN, count nothing.
class LikenessField {
 public:
  LikenessField(const std::vector<Range>& sampled, double likeness, std::uint64_t seed, std::uint64_t stream) {
    for (const Range& range : sampled) {
      const double width = range.maximum - range.minimum;
      scale_.push_back(width > 0 ? 1 / (likeness * width) : 0);
    }
    const std::size_t per_wave = scale_.size() + 2;
    for (std::uint64_t i = 0; i < kWaves * per_wave; ++i) number_.push_back(random_normal(seed, stream, i));
  }

  double at(std::span<const double> x) const {
    const std::size_t per_wave = scale_.size() + 2;
    double sum = 0;
    for (std::size_t k = 0; k < kWaves; ++k) {
      const double* wave = &number_[k * per_wave];
      double phase = 0;
      for (std::size_t v = 0; v < scale_.size(); ++v)
        if (scale_[v] > 0 && !std::isnan(x[v])) phase += wave[v] * x[v] * scale_[v];
      sum += wave[per_wave - 2] * std::cos(phase) + wave[per_wave - 1] * std::sin(phase);
    }
    return sum / std::sqrt(double(kWaves));
  }

 private:
  static constexpr std::size_t kWaves = 32;
  std::vector<double> scale_;   // [variable]
  std::vector<double> number_;  // [wave][variables, then two amplitudes]
};

/// Error of Horn's gradient at a cell, {east, north} [rise per metre], from independent errors of the heights of its
/// neighbours. Its standard deviation is that of gradient_error() (pipeline/map/evaluate/block.h).
inline std::array<double, 2> gradient_noise(int column, int row, double height_error, double cell_width,
                                            double cell_height, std::uint64_t seed, std::uint64_t stream) {
  const auto height = [&](int dx, int dy) {
    const std::uint64_t x = std::uint32_t(column + dx + 1), y = std::uint32_t(row + dy + 1);
    return random_normal(seed, stream, (y << 31) | x);
  };
  double east = 0, north = 0;
  for (const int k : {-1, 0, 1}) {
    const double weight = k == 0 ? 2 : 1;
    east += weight * (height(1, k) - height(-1, k));
    north += weight * (height(k, -1) - height(k, 1));
  }
  return {height_error * east / (8 * cell_width), height_error * north / (8 * cell_height)};
}

}  // namespace gonogo::map
