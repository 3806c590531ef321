#include "pipeline/campaign/trial/undisturbed.h"

#include <algorithm>
#include <cmath>

namespace gonogo::campaign {
namespace {

/// Height of the axle of a cylinder that touches this grain, which lies dx ahead of it and dy beside its middle: a
/// grain beyond its side is met by its edge. The base's height when the two cannot touch [m].
double touching_height(const terrain::Grain& g, double reach, double width, double dx, double dy) {
  const double beside = std::max(0.0, std::fabs(dy) - width / 2);
  if (beside >= g.radius) return reach;
  const double apart = reach + std::sqrt(g.radius * g.radius - beside * beside);
  return std::fabs(dx) < apart ? g.position.z + std::sqrt(apart * apart - dx * dx) : reach;
}

}  // namespace

double untouched_axle_height(const terrain::Packing& packing, double reach, double width, double y, double from,
                             double way, double yaw) {
  const terrain::BedSpec& bed = packing.spec;
  const double c = std::cos(yaw), s = std::sin(yaw), half_lane = width / 2 * c + reach * std::fabs(s);
  std::vector<terrain::Grain> lane;
  for (const terrain::Grain& g : terrain::lobes_of(packing))
    if (std::fabs(std::remainder(g.position.y - y, bed.width)) < half_lane + g.radius) lane.push_back(g);
  // Highest first: once a wheel stands higher than on top of the next grain, none of the others touches it.
  const auto top = [](const terrain::Grain& g) { return g.position.z + g.radius; };
  std::sort(lane.begin(), lane.end(), [&](const auto& a, const auto& b) { return top(a) > top(b); });
  const int places = std::max(8, int(4 * way / bed.grain_diameter));
  double sum = 0;
  for (int k = 0; k < places; ++k) {
    const double x = from + (k + 0.5) * way / places;
    double height = reach;
    for (const terrain::Grain& g : lane) {
      if (top(g) + reach <= height) break;
      const double dx = std::remainder(g.position.x - x, bed.length), dy = std::remainder(g.position.y - y, bed.width);
      height = std::max(height, touching_height(g, reach, width, c * dx + s * dy, c * dy - s * dx));
    }
    sum += height;
  }
  return sum / places;
}

}  // namespace gonogo::campaign
