#include "pipeline/report/picture/visible.h"
#include "base/parallel/host_loop.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace gonogo::report {
namespace {

constexpr int kBandRows = 16;
constexpr Real kNear = Real(1e-3);  // [m]

/// Samples that an item may cover, last ones excluded.
struct Window {
  int left, right, top, bottom;
};

/// A ball in the camera's frame.
struct SeenBall {
  Vec3 centre;
  Real radius;
  Window window;
};

/// A face in the camera's frame. A ray meets it where its products with all three sides have one sign.
struct SeenFace {
  Vec3 corner[3], side[3], normal;
  Window window;
};

class Scan {
 public:
  Scan(const Model& model, const Camera& camera, Visible& out) : camera_(camera), out_(out) {
    for (const Ball& b : model.ball) ball_.push_back(seen(b));
    for (const Face& f : model.face) face_.push_back(seen(f));
    sort_into_bands();
  }

  int band_count() const { return int(items_.size()); }

  void draw_band(int band) {
    const int top = band * kBandRows, bottom = std::min(out_.height, top + kBandRows);
    for (const std::int32_t item : items_[band]) {
      if (item < std::int32_t(ball_.size()))
        draw(ball_[item], item, top, bottom);
      else
        draw(face_[item - ball_.size()], item, top, bottom);
    }
  }

 private:
  /// Range of pixels between two tangents.
  void clip(Real low, Real high, int size, Real sign, int& first, int& last) const {
    const Real scale = Real(out_.height) / (2 * camera_.tan_half_height), middle = Real(size) / 2;
    const Real a = middle + sign * low * scale, b = middle + sign * high * scale;
    first = int(std::clamp(std::floor(std::min(a, b)), Real(0), Real(size)));
    last = int(std::clamp(std::ceil(std::max(a, b)) + 1, Real(0), Real(size)));
  }

  Window window(Real left, Real right, Real low, Real high) const {
    Window w;
    clip(left, right, out_.width, 1, w.left, w.right);
    clip(low, high, out_.height, -1, w.top, w.bottom);
    return w;
  }

  /// Tangents of the lines from the eye that touch a circle; z is ahead.
  static std::pair<Real, Real> touching(Real x, Real z, Real radius) {
    const Real root = radius * std::sqrt(x * x + z * z - radius * radius), below = z * z - radius * radius;
    return {(x * z - root) / below, (x * z + root) / below};
  }

  SeenBall seen(const Ball& b) const {
    const Vec3 c = camera_.seen(b.centre);
    if (c.z < b.radius + kNear) return {c, b.radius, {0, 0, 0, 0}};
    const auto [left, right] = touching(c.x, c.z, b.radius);
    const auto [low, high] = touching(c.y, c.z, b.radius);
    return {c, b.radius, window(left, right, low, high)};
  }

  SeenFace seen(const Face& f) const {
    SeenFace s;
    Real left = std::numeric_limits<Real>::max(), right = -left, low = left, high = -left, nearest = left;
    for (int k = 0; k < 3; ++k) {
      const Vec3 c = s.corner[k] = camera_.seen(f.corner[k]);
      nearest = std::min(nearest, c.z);
      left = std::min(left, c.x / c.z);
      right = std::max(right, c.x / c.z);
      low = std::min(low, c.y / c.z);
      high = std::max(high, c.y / c.z);
    }
    for (int k = 0; k < 3; ++k) s.side[k] = cross(s.corner[(k + 1) % 3], s.corner[(k + 2) % 3]);
    s.normal = cross(s.corner[1] - s.corner[0], s.corner[2] - s.corner[0]);
    s.window = nearest < kNear ? Window{0, 0, 0, 0} : window(left, right, low, high);
    return s;
  }

  void sort_into_bands() {
    items_.resize((out_.height + kBandRows - 1) / kBandRows);
    const auto put = [&](const Window& w, std::size_t item) {
      if (w.left >= w.right || w.top >= w.bottom) return;
      for (int band = w.top / kBandRows; band <= (w.bottom - 1) / kBandRows; ++band)
        items_[band].push_back(std::int32_t(item));
    };
    for (std::size_t i = 0; i < ball_.size(); ++i) put(ball_[i].window, i);
    for (std::size_t i = 0; i < face_.size(); ++i) put(face_[i].window, ball_.size() + i);
  }

  void keep_nearer(std::size_t at, Real depth, std::int32_t item) {
    if (depth >= out_.depth[at]) return;
    out_.depth[at] = depth;
    out_.item[at] = item;
  }

  void draw(const SeenBall& b, std::int32_t item, int top, int bottom) {
    const Vec3& c = b.centre;
    for (int row = std::max(top, b.window.top); row < std::min(bottom, b.window.bottom); ++row)
      for (int column = b.window.left; column < b.window.right; ++column) {
        // Measured from the point of the ray nearest to the centre: small numbers keep single precision exact enough.
        const Vec3 ray = ray_of(camera_, out_.width, out_.height, column, row);
        const Real square = dot(ray, ray), t = dot(ray, c) / square;
        const Vec3 off = ray * t - c;
        const Real half_chord = b.radius * b.radius - dot(off, off);
        if (half_chord > 0) keep_nearer(out_.at(column, row), t - std::sqrt(half_chord / square), item);
      }
  }

  void draw(const SeenFace& f, std::int32_t item, int top, int bottom) {
    const Real distance = dot(f.normal, f.corner[0]);
    for (int row = std::max(top, f.window.top); row < std::min(bottom, f.window.bottom); ++row)
      for (int column = f.window.left; column < f.window.right; ++column) {
        const Vec3 ray = ray_of(camera_, out_.width, out_.height, column, row);
        const Real a = dot(ray, f.side[0]), b = dot(ray, f.side[1]), c = dot(ray, f.side[2]);
        const bool inside = (a >= 0 && b >= 0 && c >= 0) || (a <= 0 && b <= 0 && c <= 0);
        if (inside && dot(ray, f.normal) != 0) keep_nearer(out_.at(column, row), distance / dot(ray, f.normal), item);
      }
  }

  const Camera& camera_;
  Visible& out_;
  std::vector<SeenBall> ball_;
  std::vector<SeenFace> face_;
  std::vector<std::vector<std::int32_t>> items_;  // [band], in the order of the model
};

}  // namespace

Visible find_visible(const Model& model, const Camera& camera, int width, int height, int threads) {
  Visible out{width, height, {}, {}};
  out.depth.assign(std::size_t(width) * height, std::numeric_limits<float>::max());
  out.item.assign(std::size_t(width) * height, kNothing);
  Scan scan(model, camera, out);
  const auto draw_band = [&](std::size_t band) { scan.draw_band(int(band)); };
  for_each_on_host(std::size_t(scan.band_count()), 1, draw_band, threads);
  return out;
}

Vec3 corner_shares(const Vec3 (&corner)[3], const Vec3& ray) {
  const Vec3 share{dot(ray, cross(corner[1], corner[2])), dot(ray, cross(corner[2], corner[0])),
                   dot(ray, cross(corner[0], corner[1]))};
  return share * (1 / (share.x + share.y + share.z));
}

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
  const auto light_row = [&](std::size_t row) {
    const int j = int(row);
    for (int i = 0; i < kFloorPoints; ++i) {
      const Real x = 2 * Real(i) / (kFloorPoints - 1) - 1, y = 2 * Real(j) / (kFloorPoints - 1) - 1;
      const Vec3 up{0, 0, 1}, point{light.middle.x + x * light.reach, light.middle.y + y * light.reach, height};
      Real sky = 0;
      for (std::size_t k = 1; k < light.map.size(); ++k)
        sky += light.map[k].towards_light().z * light.map[k].lit(point, up, 5);
      const Real open = std::clamp((1 - std::max(std::fabs(x), std::fabs(y))) * 4, Real(0), Real(1));
      light.floor[std::size_t(j) * kFloorPoints + i] = 1 - open * (1 - sky * 2 / Real(light.map.size() - 1));
    }
  };
  for_each_on_host(kFloorPoints, 1, light_row, threads);
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
  const auto draw = [&](std::size_t k) {
    const bool sun = k == 0;
    drawn[k].emplace(model, sun ? towards_sun : sky_direction(int(k) - 1), middle, reach,
                     sun ? kSunPixels : kSkyPixels);
  };
  for_each_on_host(drawn.size(), 1, draw, threads);
  Lighting lighting;
  for (auto& m : drawn) lighting.map.push_back(std::move(*m));
  lighting.middle = middle;
  lighting.reach = reach * Real(1.4);
  light_floor(lighting, model.floor, threads);
  return lighting;
}

}  // namespace gonogo::report
