#include "sim/scene/layout.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "base/error.h"

namespace gonogo::sim {
namespace {

constexpr Real kBinnedSizeRatio = 4;
/// So many shapes may stay out of the bins to make the bins at least so much narrower; those of similar size as the
/// others stay in.
constexpr std::size_t kFewLarge = 16;
constexpr Real kWorthwhile = 1.5, kSimilar = 1.25;

/// Bins of a world: this many whatever its shapes, and so many per binned shape.
constexpr double kMinBins = 4096, kBinsPerShape = 4;

bool is_finite(const Shape& s) { return s.type != ShapeType::plane && s.type != ShapeType::heightfield; }

/// Three bins must fit into a periodic side.
bool fits_period(const SceneWorld& world, Real radius, Real envelope) {
  const double width = 2 * double(radius) + envelope;
  return !(world.periodic_x && 3 * width > world.size.x) && !(world.periodic_y && 3 * width > world.size.y);
}

/// Largest sphere among those of similar size; 0 without spheres.
Real largest_grain(const SceneWorld& world) {
  Real least = std::numeric_limits<Real>::infinity(), largest = 0;
  for (const Shape& s : world.shape)
    if (s.type == ShapeType::sphere) least = std::min(least, s.size.x);
  for (const Shape& s : world.shape)
    if (s.type == ShapeType::sphere && s.size.x <= kBinnedSizeRatio * least) largest = std::max(largest, s.size.x);
  return largest;
}

struct Span {
  double low = std::numeric_limits<double>::infinity(), high = -low;
};

/// Where the binned shapes are at the start, without the offsets inside their bodies.
void find_spans(const SceneWorld& world, Real radius, Span (&span)[3]) {
  for (const Shape& s : world.shape) {
    if (!is_binned(s, radius)) continue;
    const Vec3d& x = world.body[s.body].position;
    const double at[3] = {x.x, x.y, x.z};
    for (int k = 0; k < 3; ++k) {
      span[k].low = std::min(span[k].low, at[k] - radius);
      span[k].high = std::max(span[k].high, at[k] + radius);
    }
  }
}

/// The whole domain where that takes few bins, otherwise the region of the shapes; fewer where even that is too much.
void choose_counts(const SceneWorld& world, double width, Real radius, double max_bins, Index (&bins)[3]) {
  const double size[3] = {world.size.x, world.size.y, world.size.z};
  const bool periodic[3] = {world.periodic_x, world.periodic_y, false};
  double count[3];
  for (int k = 0; k < 3; ++k) count[k] = std::max(3.0, std::floor(size[k] / width) + (periodic[k] ? 0 : 1));
  if (count[0] * count[1] * count[2] > max_bins) {
    Span span[3];
    find_spans(world, radius, span);
    for (int k = 0; k < 3; ++k)
      count[k] = std::min(count[k], std::max(3.0, std::ceil((span[k].high - span[k].low) / width) + 4));
  }
  while (count[0] * count[1] * count[2] > max_bins) {
    double& largest = *std::max_element(count, count + 3);
    largest = std::max(3.0, std::floor(0.8 * largest));
  }
  for (int k = 0; k < 3; ++k) bins[k] = Index(count[k]);
}

}  // namespace

bool is_binned(const Shape& s, Real binned_radius) { return is_finite(s) && bounding_radius(s) <= binned_radius; }

Real binned_radius(const SceneWorld& world, const StepSettings& settings) {
  std::vector<Real> radius;
  for (const Shape& s : world.shape)
    if (is_finite(s)) radius.push_back(bounding_radius(s));
  if (radius.empty()) return 0;
  std::sort(radius.begin(), radius.end());
  const auto within = std::upper_bound(radius.begin(), radius.end(), kBinnedSizeRatio * radius.front());
  auto limit = *(within - 1);
  if (std::size_t(within - radius.begin()) > kFewLarge) {
    const Real without = *(within - 1 - kFewLarge);
    if (limit > kWorthwhile * without)
      limit = *(std::upper_bound(radius.begin(), radius.end(), kSimilar * without) - 1);
  }
  // What does not fit into a short periodic side stays out of its bins.
  while (!fits_period(world, limit, settings.envelope)) {
    const auto smaller = std::lower_bound(radius.begin(), radius.end(), limit);
    if (smaller == radius.begin()) return 0;
    limit = *(smaller - 1);
  }
  return limit;
}

void lay_out_bins(const SceneWorld& world, const StepSettings& settings, std::size_t w, WorldParameters& p) {
  const Real radius = binned_radius(world, settings);
  const auto binned =
      std::count_if(world.shape.begin(), world.shape.end(), [&](const Shape& s) { return is_binned(s, radius); });
  if (!fits_period(world, largest_grain(world), settings.envelope))
    throw InputError("world " + std::to_string(w) +
                     ": a periodic side is shorter than three grains; make the bed larger or the grains smaller");
  if (binned == 0) {
    p.bins[0] = p.bins[1] = p.bins[2] = 3;
    p.bin_size = {Real(world.size.x / 3), Real(world.size.y / 3), Real(world.size.z / 3)};
    return;
  }
  const double width = 2 * double(radius) + settings.envelope;
  choose_counts(world, width, radius, std::max(kMinBins, kBinsPerShape * double(binned)), p.bins);
  // Bins tile a periodic side; elsewhere they have the least width and repeat.
  p.bin_size = {Real(world.periodic_x ? world.size.x / p.bins[0] : width),
                Real(world.periodic_y ? world.size.y / p.bins[1] : width), Real(width)};
}

}  // namespace gonogo::sim
