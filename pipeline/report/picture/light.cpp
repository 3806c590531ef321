#include "pipeline/report/picture/light.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace gonogo::report {
namespace {

constexpr int kSkyDirections = 28, kSunPixels = 2048, kSkyPixels = 768;

/// Even over the upper half of the sphere: equal steps in height, turned by the golden angle.
Vec3 sky_direction(int k) {
  const double z = (k + 0.5) / kSkyDirections, ring = std::sqrt(1 - z * z), angle = 2.399963229728653 * k;
  return {Real(ring * std::cos(angle)), Real(ring * std::sin(angle)), Real(z)};
}

}  // namespace

HeightMap::HeightMap(const Model& model, const Vec3& towards_light, const Vec3& middle, Real reach, int size)
    : towards_(towards_light),
      middle_(middle),
      pixel_(2 * reach / Real(size)),
      size_(size),
      height_(std::size_t(size) * size, -std::numeric_limits<float>::max()) {
  const Vec3 aside = std::fabs(towards_.z) < Real(0.9) ? Vec3{0, 0, 1} : Vec3{1, 0, 0};
  const Vec3 across = cross(aside, towards_);
  right_ = across * (1 / length(across));
  up_ = cross(towards_, right_);
  for (const Ball& b : model.ball) draw(b);
  for (const Face& f : model.face) draw(f);
}

/// Column and row in pixels, height in metres.
Vec3 HeightMap::on_map(const Vec3& p) const {
  const Vec3 d = p - middle_;
  const Real half = Real(size_) / 2;
  return {dot(d, right_) / pixel_ + half, dot(d, up_) / pixel_ + half, dot(d, towards_)};
}

void HeightMap::raise(int column, int row, Real height) {
  float& h = height_[std::size_t(row) * size_ + column];
  h = std::max(h, height);
}

void HeightMap::draw(const Ball& ball) {
  const Vec3 c = on_map(ball.centre);
  const Real radius = ball.radius / pixel_;
  const int left = std::max(0, int(c.x - radius)), right = std::min(size_ - 1, int(c.x + radius));
  const int low = std::max(0, int(c.y - radius)), high = std::min(size_ - 1, int(c.y + radius));
  for (int row = low; row <= high; ++row)
    for (int column = left; column <= right; ++column) {
      const Real x = Real(column) + Real(0.5) - c.x, y = Real(row) + Real(0.5) - c.y;
      const Real rest = radius * radius - x * x - y * y;
      if (rest > 0) raise(column, row, c.z + std::sqrt(rest) * pixel_);
    }
}

void HeightMap::draw(const Face& face) {
  Vec3 c[3];
  for (int k = 0; k < 3; ++k) c[k] = on_map(face.corner[k]);
  const Real area = (c[1].x - c[0].x) * (c[2].y - c[0].y) - (c[2].x - c[0].x) * (c[1].y - c[0].y);
  if (std::fabs(area) < Real(1e-6)) return;
  const auto [left, right] = std::minmax({c[0].x, c[1].x, c[2].x});
  const auto [low, high] = std::minmax({c[0].y, c[1].y, c[2].y});
  for (int row = std::max(0, int(low)); row <= std::min(size_ - 1, int(high)); ++row)
    for (int column = std::max(0, int(left)); column <= std::min(size_ - 1, int(right)); ++column) {
      const Real x = Real(column) + Real(0.5), y = Real(row) + Real(0.5);
      Real share[3];
      for (int k = 0; k < 3; ++k) {
        const Vec3 &a = c[(k + 1) % 3], &b = c[(k + 2) % 3];
        share[k] = ((b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x)) / area;
      }
      if (share[0] >= 0 && share[1] >= 0 && share[2] >= 0)
        raise(column, row, share[0] * c[0].z + share[1] * c[1].z + share[2] * c[2].z);
    }
}

Real HeightMap::lit(const Vec3& point, const Vec3& normal, int spread) const {
  // Asked a pixel and a half out along the normal, more where light grazes, so that a surface does not shade itself.
  const Vec3 p = on_map(point + normal * (pixel_ * (Real(1.5) + Real(0.7) * Real(spread))));
  const int column = int(std::floor(p.x)), row = int(std::floor(p.y));
  if (column < spread || row < spread || column >= size_ - spread || row >= size_ - spread) return 1;
  int open = 0;
  for (int y = row - spread; y <= row + spread; ++y)
    for (int x = column - spread; x <= column + spread; ++x) open += p.z >= height_[std::size_t(y) * size_ + x];
  const int asked = (2 * spread + 1) * (2 * spread + 1);
  return Real(open) / Real(asked);
}

Lighting::At Lighting::at(const Vec3& point, const Vec3& normal) const {
  At light{0, 0};
  const Real facing_sun = dot(normal, map[0].towards_light());
  if (facing_sun > 0) light.sun = facing_sun * map[0].lit(point, normal, 2);
  for (std::size_t k = 1; k < map.size(); ++k) {
    const Real facing = dot(normal, map[k].towards_light());
    if (facing > 0) light.sky += facing * map[k].lit(point, normal, 0);
  }
  // Over the upper half of the sphere the mean of cos is 1/2.
  light.sky *= Real(2) / Real(map.size() - 1);
  return light;
}

Real Lighting::floor_sky(const Vec3& point) const {
  const Real scale = (kFloorPoints - 1) / (2 * reach);
  const Real x = (point.x - middle.x + reach) * scale, y = (point.y - middle.y + reach) * scale;
  const int i = int(std::floor(x)), j = int(std::floor(y));
  if (i < 0 || j < 0 || i + 1 >= kFloorPoints || j + 1 >= kFloorPoints) return 1;
  const auto value = [&](int a, int b) { return floor[std::size_t(b) * kFloorPoints + a]; };
  const Real s = x - Real(i), t = y - Real(j);
  return (value(i, j) * (1 - s) + value(i + 1, j) * s) * (1 - t) +
         (value(i, j + 1) * (1 - s) + value(i + 1, j + 1) * s) * t;
}

/// Fades to open sky at the edge of the square, so that no edge is seen.
static void light_floor(Lighting& light, Real height, int threads) {
  light.floor.assign(std::size_t(kFloorPoints) * kFloorPoints, 1);
#pragma omp parallel for schedule(dynamic) num_threads(threads)
  for (int j = 0; j < kFloorPoints; ++j)
    for (int i = 0; i < kFloorPoints; ++i) {
      const Real x = 2 * Real(i) / (kFloorPoints - 1) - 1, y = 2 * Real(j) / (kFloorPoints - 1) - 1;
      const Vec3 up{0, 0, 1}, point{light.middle.x + x * light.reach, light.middle.y + y * light.reach, height};
      Real sky = 0;
      for (std::size_t k = 1; k < light.map.size(); ++k)
        sky += light.map[k].towards_light().z * light.map[k].lit(point, up, 5);
      const Real open = std::clamp((1 - std::max(std::fabs(x), std::fabs(y))) * 4, Real(0), Real(1));
      light.floor[std::size_t(j) * kFloorPoints + i] = 1 - open * (1 - sky * 2 / Real(light.map.size() - 1));
    }
}

Lighting light_model(const Model& model, const Vec3& towards_sun, int threads) {
  Vec3 low{1e9f, 1e9f, 1e9f}, high{-1e9f, -1e9f, -1e9f};
  const auto take = [&](const Vec3& p, Real r) {
    low = {std::min(low.x, p.x - r), std::min(low.y, p.y - r), std::min(low.z, p.z - r)};
    high = {std::max(high.x, p.x + r), std::max(high.y, p.y + r), std::max(high.z, p.z + r)};
  };
  for (const Ball& b : model.ball) take(b.centre, b.radius);
  for (const Face& f : model.face)
    for (const Vec3& c : f.corner) take(c, 0);
  if (model.ball.empty() && model.face.empty()) take({}, 1);
  const Vec3 middle = (low + high) * Real(0.5);
  const Real reach = length(high - low) * Real(0.505);
  std::vector<std::optional<HeightMap>> drawn(kSkyDirections + 1);
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads)
  for (int k = 0; k <= kSkyDirections; ++k) {
    const bool sun = k == 0;
    drawn[k].emplace(model, sun ? towards_sun : sky_direction(k - 1), middle, reach, sun ? kSunPixels : kSkyPixels);
  }
  Lighting lighting;
  for (auto& m : drawn) lighting.map.push_back(std::move(*m));
  lighting.middle = middle;
  lighting.reach = reach * Real(1.4);
  light_floor(lighting, model.floor, threads);
  return lighting;
}

}  // namespace gonogo::report
