// Chance to get through along a way.
//
// Cells are not independent: soil, payload, errors of the elevation and of the model last over many of them. A draw
// chooses all that nobody knows and goes the whole way on it. The chance is the share of the draws that no piece
// stops. A draw consists of:
//
//   mission    payload and the like: one value for the whole way
//   soil       one of the points that the soil may be. A soil keeps its point along the way with the correlation
//              exp(-distance / soil_length)
//   elevation  Horn's gradient of independent errors of all cells, so that neighbouring slopes err alike
//   model      the model or one of its bootstrap members, for the whole way
//   the rest   a piece stops the vehicle if P(go) < Phi(-z). z is a normal field over the variables with the
//              correlation exp(-distance^2 / 2), in units of `likeness` times the sampled ranges. A share `bed_share`
//              of its variance is drawn anew every `bed_length` instead.
//
// The last rule leaves P(go) of each piece as it is. Alike pieces end alike, because trials repeated on other beds do.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/json/config.h"
#include "base/math/random.h"
#include "pipeline/map/evaluate/outcome_model.h"

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

  static constexpr std::size_t kWaves = 32;
  /// Cosines and sines of the waves' phases.
  struct Waves {
    std::array<double, kWaves> cosine, sine;
  };
  Waves waves(std::span<const double> x) const {
    const std::size_t per_wave = scale_.size() + 2;
    Waves at;
    for (std::size_t k = 0; k < kWaves; ++k) {
      double phase = 0;
      for (std::size_t v = 0; v < scale_.size(); ++v)
        if (scale_[v] > 0 && !std::isnan(x[v])) phase += number_[k * per_wave + v] * x[v] * scale_[v];
      at.cosine[k] = std::cos(phase);
      at.sine[k] = std::sin(phase);
    }
    return at;
  }
  /// Waves at a point of which each holds some variables, and NaN in place of the others.
  static Waves joined(const Waves& a, const Waves& b) {
    Waves both;
    for (std::size_t k = 0; k < kWaves; ++k) {
      both.cosine[k] = a.cosine[k] * b.cosine[k] - a.sine[k] * b.sine[k];
      both.sine[k] = a.sine[k] * b.cosine[k] + a.cosine[k] * b.sine[k];
    }
    return both;
  }
  double at(const Waves& waves) const {
    const std::size_t per_wave = scale_.size() + 2;
    double sum = 0;
    for (std::size_t k = 0; k < kWaves; ++k) {
      const double* amplitude = &number_[k * per_wave + scale_.size()];
      sum += amplitude[0] * waves.cosine[k] + amplitude[1] * waves.sine[k];
    }
    return sum / std::sqrt(double(kWaves));
  }
  double at(std::span<const double> x) const { return at(waves(x)); }

 private:
  std::vector<double> scale_;   // [variable]
  std::vector<double> number_;  // [wave][variables, then two amplitudes]
};

/// Number of a cell's random height, also of cells just outside of the map.
inline std::uint64_t height_number(int column, int row) {
  return (std::uint64_t(std::uint32_t(row + 1)) << 31) | std::uint32_t(column + 1);
}

/// Error of Horn's gradient at a cell, {east, north} [rise per metre], from independent errors of the heights of its
/// neighbours: height(dx, dy), of variance 1. Its standard deviation is that of gradient_error()
/// (pipeline/map/evaluate/soil_table.h).
template <class Height>
std::array<double, 2> gradient_noise(const Height& height, double height_error, double cell_width, double cell_height) {
  double east = 0, north = 0;
  for (const int k : {-1, 0, 1}) {
    const double weight = k == 0 ? 2 : 1;
    east += weight * (height(1, k) - height(-1, k));
    north += weight * (height(k, -1) - height(k, 1));
  }
  return {height_error * east / (8 * cell_width), height_error * north / (8 * cell_height)};
}
inline std::array<double, 2> gradient_noise(int column, int row, double height_error, double cell_width,
                                            double cell_height, std::uint64_t seed, std::uint64_t stream) {
  const auto height = [&](int dx, int dy) { return random_normal(seed, stream, height_number(column + dx, row + dy)); };
  return gradient_noise(height, height_error, cell_width, cell_height);
}

/// What a soil on the way may be: equally likely points over the variables of the contract, NaN where unknown. All of
/// them lie in the sampled box; slopes are ignored.
struct WaySoil {
  std::string name;
  std::vector<std::vector<double>> points;  // [point][variable]
  double not_sampled = 0;                   // share of the soil that no trial answers for; not among the points
};

/// A piece of the way inside one cell.
struct WayPiece {
  double begin = 0, end = 0;             // distance on the ground from the start of the way [m]
  std::size_t soil = 0;                  // position in the list of soils
  double rise_east = 0, rise_north = 0;  // uphill gradient of the ground [rise per metre]
  double heading = 0;                    // [deg clockwise from grid north]
  int column = 0, row = 0;               // cell; equal cells err alike
};

/// Rises per metre along the heading (uphill positive) and across it (left side up positive).
struct SlopesOnWay {
  double along = 0, across = 0;
};
/// `error`: of the gradient, {east, north} [rise per metre].
SlopesOnWay slopes_on_way(const WayPiece& piece, std::array<double, 2> error = {0, 0});

/// What is not known on a way.
struct PassageDoubt {
  double soil_length = 1000;                 // [m] > 0
  double likeness = 0.3;                     // length of the rest's field [sampled range of a variable] > 0
  double bed_share = 0.05;                   // [0, 1]
  double bed_length = 100;                   // [m] > 0; also joins stops that are nearer into one place
  double height_error = 0;                   // standard error of a cell's height that its neighbours do not share [m]
  double cell_width = 10, cell_height = 10;  // [m]
  int draws = 400;
  std::uint64_t seed = 1;
};

/// Where the vehicle gets stuck most often: pieces around the weakest one that stop it at least half as often.
struct WeakestStretch {
  double begin = 0, end = 0;        // from the start of the way [m]
  double stuck = 0;                 // share of the draws that stop in it
  std::size_t outcome = 0;          // likeliest outcome there of the draws that stop, in contract().outcomes
  std::size_t piece = 0;            // the weakest piece
  std::size_t first = 0, last = 0;  // pieces of the stretch
};

struct PassageForecast {
  double chance = 1;                      // share of the draws that get through
  double error = 0;                       // its standard error
  double places = 0;                      // mean number of places where the vehicle gets stuck
  double not_sampled = 0;                 // chance that some soil on the way is what no trial answers for
  std::vector<double> stuck;              // [piece] share of the draws that it stops
  std::optional<WeakestStretch> weakest;  // none if no draw stops
};

/// Forecasts the passage over `pieces`, which follow each other. The same bits for any number of threads.
PassageForecast forecast_passage(const std::vector<WayPiece>& pieces, const std::vector<WaySoil>& soils,
                                 const OutcomeModel& model, const PassageDoubt& doubt);

/// Where the vehicle gets stuck most often on a way that was found.
struct StuckStretch {
  double begin = 0, end = 0;                  // from the start of the way [m]
  double stuck = 0;                           // share of the draws that stop in it
  std::string reason, soil;                   // likeliest reason there; soil at the weakest piece
  double slope_along = 0, slope_across = 0;   // at the weakest piece [deg]
  std::vector<std::array<double, 2>> line{};  // in the grid's coordinate system
};

/// The chance to get through a way that was found, as PassageForecast.
struct Passage {
  double chance = 1, error = 0, places = 0, not_sampled = 0;
  std::optional<StuckStretch> weakest;
};

}  // namespace gonogo::map
