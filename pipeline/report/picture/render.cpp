#include "pipeline/report/picture/render.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/parallel/host_loop.h"
#include "pipeline/report/picture/visible.h"

namespace gonogo::report {
namespace {

/// Tangents of what a camera sees of a set of points, and the least distance of any of them.
struct Extent {
  double left = std::numeric_limits<double>::max(), right = -left, bottom = left, top = -left, nearest = left;
};

Extent extent_of(const Camera& camera, const std::vector<Vec3>& points) {
  Extent e;
  for (const Vec3& p : points) {
    const Vec3 s = camera.seen(p);
    e.nearest = std::min(e.nearest, double(s.z));
    e.left = std::min(e.left, double(s.x) / s.z);
    e.right = std::max(e.right, double(s.x) / s.z);
    e.bottom = std::min(e.bottom, double(s.y) / s.z);
    e.top = std::max(e.top, double(s.y) / s.z);
  }
  return e;
}

std::vector<Vec3> outline(const Model& model) {
  std::vector<Vec3> points;
  for (const Ball& b : model.ball)
    for (const Real side : {b.radius, -b.radius})
      for (const Vec3& off : {Vec3{side, 0, 0}, Vec3{0, side, 0}, Vec3{0, 0, side}}) points.push_back(b.centre + off);
  for (const Face& f : model.face) points.insert(points.end(), f.corner, f.corner + 3);
  if (points.empty()) points = {{-1, -1, -1}, {1, 1, 1}};
  return points;
}

}  // namespace

Camera frame_model(const Model& model, double azimuth, double elevation, double aspect, const Margins& m) {
  const std::vector<Vec3> points = outline(model);
  Vec3 low = points.front(), high = low;
  for (const Vec3& p : points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  Camera c;
  const double a = azimuth, e = elevation;
  c.right = {Real(std::cos(a)), Real(std::sin(a)), 0};
  c.forward = {Real(-std::sin(a) * std::cos(e)), Real(std::cos(a) * std::cos(e)), Real(-std::sin(e))};
  c.up = cross(c.right, c.forward);
  // Each round measures the picture from the present place, then moves sideways to centre it between the margins and
  // along the view to fill them; perspective makes it a fixed point, reached to a pixel in a few rounds.
  const double t = c.tan_half_height, wide = (1 - m.left - m.right) * t * aspect, tall = (1 - m.top - m.bottom) * t;
  const Vec3 middle = (low + high) * Real(0.5);
  double distance = 4 * length(high - low) + 1, across = 0, rise = 0;
  for (int round = 0; round < 30; ++round) {
    c.eye = middle + c.right * Real(across) + c.up * Real(rise) - c.forward * Real(distance);
    const Extent x = extent_of(c, points);
    const double grow = std::max((x.right - x.left) / (2 * wide), (x.top - x.bottom) / (2 * tall));
    across += ((x.left + x.right) / 2 - (m.left - m.right) * t * aspect * grow) * distance;
    rise += ((x.bottom + x.top) / 2 - (m.bottom - m.top) * t * grow) * distance;
    distance = std::max(distance * grow, distance - 0.9 * x.nearest);
  }
  return c;
}

namespace {

constexpr int kSamples = 2;  // per pixel and axis
constexpr Light kSun{1.18f, 1.10f, 0.97f}, kSky{0.50f, 0.55f, 0.62f}, kBounce{0.10f, 0.09f, 0.08f},
    kPaper{0.93f, 0.94f, 0.95f};

struct Hit {
  Vec3 point, normal;  // level frame
  Light colour;
};

class Shader {
 public:
  Shader(const Model& model, const Camera& camera, const Visible& visible, const Lighting& lighting)
      : model_(model), camera_(camera), visible_(visible), lighting_(lighting) {}

  /// Mean of the samples of a pixel; each item is shaded once, where the pixel sees it first.
  Light pixel(int column, int row) const {
    std::array<std::int32_t, kSamples * kSamples> item{};
    std::array<Light, kSamples * kSamples> light;
    Light sum;
    for (int k = 0; k < kSamples * kSamples; ++k) {
      const int x = kSamples * column + k % kSamples, y = kSamples * row + k / kSamples;
      item[k] = visible_.item[visible_.at(x, y)];
      const auto before = std::find(item.begin(), item.begin() + k, item[k]) - item.begin();
      light[k] = before < k ? light[before] : sample(x, y, item[k]);
      sum += light[k];
    }
    return sum * (Real(1) / (kSamples * kSamples));
  }

 private:
  Vec3 into_level(const Vec3& seen) const {
    return camera_.right * seen.x + camera_.up * seen.y + camera_.forward * seen.z;
  }

  Light sample(int x, int y, std::int32_t item) const {
    const Vec3 ray = ray_of(camera_, visible_.width, visible_.height, x, y);
    if (item == kNothing) return backdrop(into_level(ray));
    const Real depth = visible_.depth[visible_.at(x, y)];
    return shaded(hit(item, ray, camera_.eye + into_level(ray * depth)), into_level(ray));
  }

  Hit hit(std::int32_t item, const Vec3& ray, const Vec3& point) const {
    if (item < std::int32_t(model_.ball.size())) {
      const Ball& b = model_.ball[item];
      const Vec3 out = point - b.centre;
      return {point, out * (1 / length(out)), b.colour};
    }
    const Face& f = model_.face[item - model_.ball.size()];
    const Vec3 corner[3] = {camera_.seen(f.corner[0]), camera_.seen(f.corner[1]), camera_.seen(f.corner[2])};
    const Vec3 share = corner_shares(corner, ray);
    Vec3 normal = f.normal[0] * share.x + f.normal[1] * share.y + f.normal[2] * share.z;
    normal *= 1 / length(normal);
    return {point, dot(normal, point - camera_.eye) > 0 ? -normal : normal, f.colour};
  }

  Light shaded(const Hit& h, const Vec3& ray) const {
    const Lighting::At light = lighting_.at(h.point, h.normal);
    // What the ground throws back reaches surfaces that look down, where the sky reaches the ground beside them.
    const Real from_below = Real(0.5) - Real(0.5) * h.normal.z;
    Light result = scale(h.colour, kSun * light.sun + kSky * light.sky + kBounce * (Real(0.4) + from_below));
    // A soft gloss (Blinn 1977) tells rubber and steel from a hole.
    const Vec3 half = lighting_.map[0].towards_light() - ray * (1 / length(ray));
    const Real gloss = std::max(Real(0), dot(half, h.normal) / length(half));
    return result + kSun * (Real(0.045) * light.sun * std::pow(gloss, Real(24)));
  }

  /// Paper white, darkened where the model keeps light from the floor.
  Light backdrop(const Vec3& ray) const {
    const Real fall = ray.z < 0 ? (model_.floor - camera_.eye.z) / ray.z : Real(-1);
    if (fall <= 0) return kPaper;
    const Vec3 up{0, 0, 1}, point = camera_.eye + ray * fall;
    const Real sun = lighting_.map[0].lit(point, up, 4), sky = lighting_.floor_sky(point);
    return kPaper * (Real(0.30) + Real(0.30) * sun + Real(0.40) * sky);
  }

  const Model& model_;
  const Camera& camera_;
  const Visible& visible_;
  const Lighting& lighting_;
};

}  // namespace

std::uint8_t srgb(Real light) {
  const Real x = std::clamp(light, Real(0), Real(1));
  // IEC 61966-2-1.
  const Real code = x <= Real(0.0031308) ? Real(12.92) * x : Real(1.055) * std::pow(x, Real(1 / 2.4)) - Real(0.055);
  return std::uint8_t(std::lround(255 * code));
}

Image render(const Model& model, const Camera& camera, int width, int height, int threads) {
  // Over the viewer's left shoulder.
  const Vec3 back{-camera.forward.x, -camera.forward.y, 0};
  const Vec3 sun = camera.right * Real(-0.55) + back * (Real(0.5) / length(back)) + Vec3{0, 0, Real(0.95)};
  const Lighting lighting = light_model(model, sun * (1 / length(sun)), threads);
  const Visible visible = find_visible(model, camera, kSamples * width, kSamples * height, threads);
  const Shader shader(model, camera, visible, lighting);
  Image image{width, height, std::vector<std::uint8_t>(std::size_t(width) * height * 3)};
  const auto draw_row = [&](std::size_t row) {
    for (int column = 0; column < width; ++column) {
      const Light light = shader.pixel(column, int(row));
      std::uint8_t* rgb = &image.rgb[(row * std::size_t(width) + std::size_t(column)) * 3];
      rgb[0] = srgb(light.x);
      rgb[1] = srgb(light.y);
      rgb[2] = srgb(light.z);
    }
  };
  for_each_on_host(std::size_t(height), 8, draw_row, threads);
  return image;
}

}  // namespace gonogo::report
