#include "pipeline/report/picture/visible.h"

#include <algorithm>
#include <cmath>
#include <limits>

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
#pragma omp parallel for schedule(dynamic) num_threads(threads)
  for (int band = 0; band < scan.band_count(); ++band) scan.draw_band(band);
  return out;
}

Vec3 corner_shares(const Vec3 (&corner)[3], const Vec3& ray) {
  const Vec3 share{dot(ray, cross(corner[1], corner[2])), dot(ray, cross(corner[2], corner[0])),
                   dot(ray, cross(corner[0], corner[1]))};
  return share * (1 / (share.x + share.y + share.z));
}

}  // namespace gonogo::report
