#include "sim/scene/order.h"

#include <algorithm>
#include <cstdlib>
#include <numeric>

#include "sim/contact/bins.h"

namespace gonogo::sim {
namespace {

/// Interleaves the lowest ten bits of three numbers: neighbours in space get close numbers.
std::uint32_t interleaved(const BinCoordinates& bin) {
  std::uint32_t code = 0;
  for (int bit = 0; bit < 10; ++bit)
    code |= (std::uint32_t(bin.x >> bit & 1) << (3 * bit)) | (std::uint32_t(bin.y >> bit & 1) << (3 * bit + 1)) |
            (std::uint32_t(bin.z >> bit & 1) << (3 * bit + 2));
  return code;
}

constexpr double kCellsAlong = 1023;  // ten bits

/// Place of each in ascending order of its code.
std::vector<Index> places_along(const std::vector<BinCoordinates>& bin) {
  std::vector<std::uint32_t> code;
  for (const BinCoordinates& b : bin) code.push_back(interleaved(b));
  std::vector<Index> sorted(bin.size()), place(bin.size());
  std::iota(sorted.begin(), sorted.end(), 0);
  std::stable_sort(sorted.begin(), sorted.end(), [&](Index a, Index b) { return code[a] < code[b]; });
  for (std::size_t k = 0; k < bin.size(); ++k) place[sorted[k]] = Index(k);
  return place;
}

/// Fewer successors than this share of what sorting would bring, and bodies are sorted anew.
constexpr double kMinOrder = 0.8;

bool are_beside(const BinCoordinates& a, const BinCoordinates& b) {
  return std::abs(a.x - b.x) <= 1 && std::abs(a.y - b.y) <= 1 && std::abs(a.z - b.z) <= 1;
}

std::size_t beside_their_successor(const std::vector<BinCoordinates>& bin) {
  std::size_t count = 0;
  for (std::size_t b = 1; b < bin.size(); ++b) count += are_beside(bin[b - 1], bin[b]);
  return count;
}

}  // namespace

std::vector<BodyIndex> spatial_order(const std::vector<Vec3d>& position, const WorldParameters& world) {
  std::vector<BinCoordinates> bin;
  for (const Vec3d& x : position) bin.push_back(bin_of(world, x));
  return places_along(bin);
}

std::vector<Index> order_along_curve(const std::vector<Vec3d>& position) {
  Vec3d low = position.at(0), high = low;
  for (const Vec3d& x : position) {
    low = {std::min(low.x, x.x), std::min(low.y, x.y), std::min(low.z, x.z)};
    high = {std::max(high.x, x.x), std::max(high.y, x.y), std::max(high.z, x.z)};
  }
  const double cell = std::max({high.x - low.x, high.y - low.y, high.z - low.z, 1e-9}) / kCellsAlong;
  std::vector<BinCoordinates> bin;
  for (const Vec3d& x : position)
    bin.push_back({Index((x.x - low.x) / cell), Index((x.y - low.y) / cell), Index((x.z - low.z) / cell)});
  return places_along(bin);
}

bool have_mixed(const std::vector<Vec3d>& position, const std::vector<BodyIndex>& place, const WorldParameters& world) {
  std::vector<BinCoordinates> bin(position.size()), sorted(position.size());
  for (std::size_t b = 0; b < bin.size(); ++b) bin[b] = sorted[place[b]] = bin_of(world, position[b]);
  return double(beside_their_successor(bin)) < kMinOrder * double(beside_their_successor(sorted));
}

std::vector<BodyIndex> composed(const std::vector<BodyIndex>& first, const std::vector<BodyIndex>& second) {
  std::vector<BodyIndex> both;
  for (const BodyIndex place : first) both.push_back(second[place]);
  return both;
}

}  // namespace gonogo::sim
