#include "sim/world/order.h"

#include <algorithm>
#include <cstdlib>
#include <numeric>

#include "sim/broad_phase/bins.h"

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

/// Fewer successors than this share of what sorting would bring, and bodies are sorted anew.
constexpr double kLeastOrder = 0.8;

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
  const std::size_t count = position.size();
  std::vector<std::uint32_t> code(count);
  for (std::size_t b = 0; b < count; ++b) code[b] = interleaved(bin_of(world, position[b]));
  std::vector<BodyIndex> sorted(count), place(count);
  std::iota(sorted.begin(), sorted.end(), 0);
  std::stable_sort(sorted.begin(), sorted.end(), [&](BodyIndex a, BodyIndex b) { return code[a] < code[b]; });
  for (std::size_t k = 0; k < count; ++k) place[sorted[k]] = BodyIndex(k);
  return place;
}

bool have_mixed(const std::vector<Vec3d>& position, const std::vector<BodyIndex>& place, const WorldParameters& world) {
  std::vector<BinCoordinates> bin(position.size()), sorted(position.size());
  for (std::size_t b = 0; b < bin.size(); ++b) bin[b] = sorted[place[b]] = bin_of(world, position[b]);
  return double(beside_their_successor(bin)) < kLeastOrder * double(beside_their_successor(sorted));
}

std::vector<BodyIndex> composed(const std::vector<BodyIndex>& first, const std::vector<BodyIndex>& second) {
  std::vector<BodyIndex> both;
  for (const BodyIndex place : first) both.push_back(second[place]);
  return both;
}

}  // namespace gonogo::sim
