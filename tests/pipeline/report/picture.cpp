// The renderer against closed forms and brute force.
#include <algorithm>
#include <cmath>
#include <set>

#include "base/units.h"
#include "pipeline/report/picture/render.h"
#include "pipeline/report/picture/visible.h"
#include "sim/scene/scene.h"
#include "sim/shape/meshes.h"
#include "tests/support/catch.h"
#include "tests/support/draw.h"
#include "tests/support/scenes.h"

namespace gonogo::report {

namespace {

using test::Draw;

/// Looks along +y from a distance; x right, z up.
Camera camera_at(Real distance, Real tan_half_height) {
  Camera c;
  c.eye = {0, -distance, 0};
  c.right = {1, 0, 0};
  c.up = {0, 0, 1};
  c.forward = {0, 1, 0};
  c.tan_half_height = tan_half_height;
  return c;
}

Face face(const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 across = cross(b - a, c - a), n = across * (1 / length(across));
  return {{a, b, c}, {n, n, n}, {0.5f, 0.5f, 0.5f}};
}

/// A square floor of this half edge at height 0, facing up.
void add_floor(Model& m, Real half) {
  m.face.push_back(face({-half, -half, 0}, {half, -half, 0}, {half, half, 0}));
  m.face.push_back(face({-half, -half, 0}, {half, half, 0}, {-half, half, 0}));
}

Model random_model(std::uint64_t seed, int balls, int faces) {
  Draw draw(seed);
  Model m;
  for (int i = 0; i < balls; ++i)
    m.ball.push_back({static_cast<Vec3>(draw.in_box({-1, -1, -0.6}, {1, 1, 0.6})),
                      Real(draw.between(0.02, 0.2)),
                      {0.5f, 0.4f, 0.3f}});
  for (int i = 0; i < faces; ++i) {
    const auto a = static_cast<Vec3>(draw.in_box({-1, -1, -0.6}, {1, 1, 0.6}));
    m.face.push_back(
        face(a, a + static_cast<Vec3>(draw.direction() * 0.5), a + static_cast<Vec3>(draw.direction() * 0.5)));
  }
  m.floor = -1;
  return m;
}

/// Distance along the ray at which it meets an item, in double precision; negative: missed. `clear` tells by how much
/// the ray would have to move to change the answer between hit and miss.
double meeting(const Model& m, std::size_t item, const Vec3d& eye, const Vec3d& ray, double& clear) {
  if (item < m.ball.size()) {
    const Vec3d c = static_cast<Vec3d>(m.ball[item].centre) - eye;
    const double t = dot(ray, c) / dot(ray, ray), r = m.ball[item].radius, off = length(ray * t - c);
    clear = std::fabs(off - r);
    return off < r ? t - std::sqrt((r * r - off * off) / dot(ray, ray)) : -1;
  }
  // Cramer's rule for eye + t ray = a + u (b - a) + v (c - a).
  const Face& f = m.face[item - m.ball.size()];
  const auto a = static_cast<Vec3d>(f.corner[0]), e1 = static_cast<Vec3d>(f.corner[1]) - a,
             e2 = static_cast<Vec3d>(f.corner[2]) - a, s = eye - a;
  const double det = dot(cross(ray, e2), e1);
  const double u = dot(cross(ray, e2), s) / det, v = dot(cross(s, e1), ray) / det, t = dot(cross(s, e1), e2) / det;
  clear = std::min({std::fabs(u), std::fabs(v), std::fabs(1 - u - v)}) * 0.1;
  return u >= 0 && v >= 0 && u + v <= 1 ? t : -1;
}

}  // namespace

TEST_CASE("every sample sees what brute force in double precision finds nearest") {
  const Model model = random_model(31, 60, 40);
  const Camera camera = camera_at(5, 0.2f);
  const int width = 160, height = 120;
  const Visible v = find_visible(model, camera, width, height, 2);
  int checked = 0, hits = 0;
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column) {
      const Vec3 seen = ray_of(camera, width, height, column, row);
      const Vec3d eye{0, -5, 0}, ray{seen.x, 1, seen.y};
      double nearest = 1e30, second = 1e30, doubt = 1;
      std::int32_t item = kNothing;
      for (std::size_t i = 0; i < model.ball.size() + model.face.size(); ++i) {
        double clear = 0;
        const double t = meeting(model, i, eye, ray, clear);
        doubt = std::min(doubt, clear);
        if (t > 0 && t < nearest) {
          second = nearest;
          nearest = t;
          item = std::int32_t(i);
        } else if (t > 0)
          second = std::min(second, t);
      }
      if (doubt < 1e-5 || (item != kNothing && second - nearest < 1e-5))
        continue;  // an edge or a tie to single precision
      ++checked;
      hits += item != kNothing;
      REQUIRE(v.item[v.at(column, row)] == item);
      if (item != kNothing) REQUIRE(v.depth[v.at(column, row)] == Approx(nearest).epsilon(1e-5));
    }
  CHECK(checked > width * height * 9 / 10);
  CHECK(hits > width * height / 4);
}

TEST_CASE("a ball covers the area of its silhouette and is as near as its front") {
  Model m;
  m.ball.push_back({{0, 0, 0}, 0.5f, {1, 1, 1}});
  const int size = 600;
  const Visible v = find_visible(m, camera_at(4, 0.2f), size, size, 1);
  const auto covered = std::count(v.item.begin(), v.item.end(), 0);
  // The tangent cone has half angle asin(r / d); its circle in the picture plane has radius tan of it.
  const double tangent = std::tan(std::asin(0.5 / 4)), pixel = 2 * 0.2 / size;
  CHECK(double(covered) == Approx(kPi * tangent * tangent / (pixel * pixel)).epsilon(2e-3));
  CHECK(v.depth[v.at(size / 2, size / 2)] == Approx(3.5).epsilon(1e-5));
}

TEST_CASE("an open floor has all of the sun and the sky; beside a long wall half of the sky is left") {
  Model m;
  add_floor(m, 1);
  const Vec3 sun{0.6f, 0, 0.8f}, up{0, 0, 1};
  const auto open = light_model(m, sun, 1).at({0, 0, 0}, up);
  CHECK(open.sun == Approx(0.8).epsilon(1e-6));
  CHECK(open.sky == Approx(1).epsilon(0.01));  // a sum over a few dozen directions instead of an integral
  // A wall in the plane x = 0.02, much longer and higher than its distance: half of every direction's weight is gone.
  m.face.push_back(face({0.02f, -1, 0}, {0.02f, 1, 0}, {0.02f, 1, 1}));
  m.face.push_back(face({0.02f, -1, 0}, {0.02f, 1, 1}, {0.02f, -1, 1}));
  const auto walled = light_model(m, sun, 1).at({0, 0, 0}, up);
  CHECK(walled.sun == 0);
  CHECK(walled.sky == Approx(0.5).margin(0.08));
}

TEST_CASE("a ball's shadow lies where the sun's rays through it meet the floor") {
  Model m;
  add_floor(m, 2);
  m.ball.push_back({{0, 0, 0.5f}, 0.2f, {1, 1, 1}});
  const Vec3 sun{0.6f, 0, 0.8f}, up{0, 0, 1};
  const Lighting light = light_model(m, sun, 1);
  // The centre's shadow is at x = -0.5 * 0.6 / 0.8; it is an ellipse with half axes r / 0.8 and r.
  const Real x = -0.375f;
  for (const Real share : {0.0f, 0.8f, -0.8f}) {
    CHECK(light.at({x + share * 0.25f, 0, 0}, up).sun == 0);
    CHECK(light.at({x, share * 0.2f, 0}, up).sun == 0);
  }
  for (const Real share : {1.2f, -1.2f}) {
    CHECK(light.at({x + share * 0.25f, 0, 0}, up).sun == Approx(0.8));
    CHECK(light.at({x, share * 0.2f, 0}, up).sun == Approx(0.8));
  }
  // The ball does not shade its own lit side.
  for (const Real tilt : {-0.5f, 0.0f, 0.5f}) {
    const Vec3 n = sun * std::cos(tilt) + Vec3{0, std::sin(tilt), 0};
    CHECK(light.at(m.ball[0].centre + n * 0.2f, n).sun == Approx(std::cos(tilt)).epsilon(1e-4));
  }
  CHECK(light.at({0, 0, 0.3f}, {0, 0, -1}).sun == 0);
}

TEST_CASE("a bed under tilted gravity is drawn rising by its slope, around the wheel") {
  const double slope = to_radians(20);
  sim::SceneWorld w;
  w.gravity = test::tilted_gravity(slope);
  w.size = {4, 1, 2};
  w.periodic_x = w.periodic_y = true;
  w.add_sphere({3.9, 0.5, 0.2}, 0.05f, 2600, 0);  // its image at -0.1 is nearer to the focus
  w.add_sphere({1.5, 0.5, 0.2}, 0.05f, 2600, 0);
  const auto wheel = w.add_sphere({0.5, 0.5, 0.2}, 0.05f, 2600, 0);
  const Model m = model_of(w, {0, w.body, {}}, {GrainColour::speed, 0, 1, wheel});
  REQUIRE(m.ball.size() == 3);
  const Vec3 back = m.ball[0].centre, front = m.ball[1].centre, middle = m.ball[2].centre;
  CHECK((front.z - middle.z) / (front.x - middle.x) == Approx(std::tan(slope)));
  CHECK(length(front - middle) == Approx(1));
  CHECK(length(back - middle) == Approx(0.6));
  CHECK(back.x < middle.x);
}

TEST_CASE("a vehicle wider than its bed is drawn in one piece, on as many beds as it takes") {
  sim::SceneWorld w;
  w.size = {4, 1, 2};
  w.periodic_x = w.periodic_y = true;
  w.add_sphere({1, 0.1, 0.2}, 0.05f, 2600, 0);
  const auto frame = w.add_body({{2, 0.5, 1}, {}, {}, {}}, sim::solid(10, {1, 1, 1}));
  for (const double side : {0.7, -0.7}) {
    const auto hub = w.add_sphere({2, 0.5 + side, 1}, 0.3f, 1000, 0);
    w.joint.push_back(sim::revolute(w, hub, frame, {2, 0.5 + side, 1}, {0, 1, 0}));
  }
  sim::Capture now{0, w.body, {}};
  for (sim::BodyState& b : now.body) b.position.y -= std::floor(b.position.y);
  now.body[std::size_t(frame)].position.x = 3.9;  // its hubs have gone through the end
  now.body[std::size_t(frame) + 1].position.x = now.body[std::size_t(frame) + 2].position.x = 3.9 - 4;
  const Model m = model_of(w, now, {GrainColour::speed, 0, 1, frame});
  REQUIRE(m.ball.size() == 3 + 2);  // a grain and its images; the hubs once each
  CHECK(m.ball[1].centre.y - m.ball[0].centre.y == Approx(1));
  CHECK(m.ball[2].centre.y - m.ball[1].centre.y == Approx(1));
  CHECK(m.ball[3].centre.y == Approx(0.7));
  CHECK(m.ball[4].centre.y == Approx(-0.7));
  for (const std::size_t k : {3u, 4u}) CHECK(m.ball[k].centre.x == Approx(0).margin(1e-5));
}

TEST_CASE("a bed stands on a block of ground that is level below") {
  sim::SceneWorld w;
  w.gravity = test::tilted_gravity(0.3);
  w.size = {4, 1, 2};
  w.periodic_x = w.periodic_y = true;
  const auto base = w.add_body({}, sim::fixed_body());
  sim::Shape s;
  s.body = base;
  s.size = {0.05f, 0, 0};
  s.offset_B = {1, 0.5f, 0};
  w.add_shape(s);
  w.add_sphere({1, 0.5, 0.1}, 0.05f, 2600, 0);
  const Model m = model_of(w, {0, w.body, {}}, {});
  REQUIRE(m.face.size() == 10);
  int on_floor = 0;
  Real high = m.floor, low = high + 10;
  for (const Face& f : m.face)
    for (const Vec3& c : f.corner) {
      on_floor += c.z == m.floor;
      if (c.z > m.floor) {
        low = std::min(low, c.z);
        high = std::max(high, c.z);
      }
    }
  CHECK(on_floor == 12);  // of each upright side's six corners three
  CHECK(high - low == Approx(4 * std::sin(0.3)));
}

TEST_CASE("a heightfield and a mesh are seen in their outlines") {
  // A slope that rises from a level edge to the ridge z = 0.4 - |x| behind it, and a box above it, from so far away
  // that rays are parallel.
  sim::SceneWorld w;
  w.origin = {-1, -1, -1};
  w.size = {2, 2, 2};
  sim::Shape s;
  s.type = sim::ShapeType::heightfield;
  s.surface = w.add_heightfield({"ridge", 3, 2, 0.6f, 1, {-0.2f, -0.2f, -0.2f, -0.2f, 0.4f, -0.2f}});
  s.body = w.add_body({}, sim::fixed_body());
  w.add_shape(s);
  s.type = sim::ShapeType::mesh;
  s.surface = w.add_mesh(sim::box_mesh({0.1f, 0.1f, 0.2f}));
  s.body = w.add_body({{0.3, 0, 0.5}, {}, {}, {}}, sim::solid(1, {1, 1, 1}));
  w.add_shape(s);
  const Model m = model_of(w, {0, w.body, {}}, {});
  REQUIRE(m.face.size() == 4 + 12);
  CHECK(length(m.face.front().colour - m.face.back().colour) > 0.05f);  // ground and what moves
  const int size = 400;
  const Camera camera = camera_at(1000, 0.001f);
  const Visible v = find_visible(m, camera, size, size, 1);
  int wrong = 0, box = 0;
  for (int row = 0; row < size; ++row)
    for (int column = 0; column < size; ++column) {
      const Vec3 ray = ray_of(camera, size, size, column, row);
      const double x = 1000.0 * ray.x, z = 1000.0 * ray.y;
      const bool in_box = std::fabs(x - 0.3) < 0.1 && std::fabs(z - 0.5) < 0.2;
      const bool on_slope = std::fabs(x) < 0.6 && z > -0.2 && z < 0.4 - std::fabs(x);
      const std::int32_t item = v.item[v.at(column, row)];
      box += item >= 4;
      wrong += (item != kNothing) != (in_box || on_slope);
    }
  // Outlines are 3.2 units long, 640 pixels; a pixel on one may be rounded either way.
  CHECK(wrong < 100);
  CHECK(box == Approx(0.2 * 0.4 * size * size / 4).epsilon(0.02));
}

TEST_CASE("the camera comes as near as the margins allow") {
  const Model m = random_model(5, 200, 5);
  const Margins margins{0.1, 0.2, 0.15, 0.05};
  const int width = 1600, height = 900;
  const Camera c = frame_model(m, 0.4, 0.3, double(width) / height, margins);
  const Visible v = find_visible(m, c, width, height, 2);
  int left = width, right = 0, top = height, bottom = 0;
  for (int row = 0; row < height; ++row)
    for (int column = 0; column < width; ++column) {
      if (v.item[v.at(column, row)] == kNothing) continue;
      left = std::min(left, column);
      right = std::max(right, column);
      top = std::min(top, row);
      bottom = std::max(bottom, row);
    }
  // Outlines are taken at six points of a ball: what is between them may stick out by a few pixels.
  CHECK(left >= 0.1 * width - 12);
  CHECK(right <= 0.8 * width + 12);
  CHECK(top >= 0.15 * height - 12);
  CHECK(bottom <= 0.95 * height + 12);
  const bool fills_width = right - left > 0.7 * width - 24, fills_height = bottom - top > 0.8 * height - 24;
  CHECK((fills_width || fills_height));
  CHECK(c.right.z == 0);  // the horizon is level
}

TEST_CASE("a picture has the same bytes with one, two and seven threads") {
  const Model m = random_model(9, 300, 30);
  const Camera c = frame_model(m, 0.3, 0.25, 1.5, {});
  const Image one = render(m, c, 240, 160, 1);
  CHECK(one.rgb == render(m, c, 240, 160, 2).rgb);
  CHECK(one.rgb == render(m, c, 240, 160, 7).rgb);
  CHECK(std::set<std::uint8_t>(one.rgb.begin(), one.rgb.end()).size() > 100);
}

TEST_CASE("an empty model gives an empty sheet") {
  const Image image = render({}, camera_at(3, 0.2f), 64, 48, 1);
  CHECK(std::all_of(image.rgb.begin(), image.rgb.end(), [](std::uint8_t x) { return x > 240; }));
}

TEST_CASE("linear light becomes sRGB codes") {
  CHECK(srgb(0) == 0);
  CHECK(srgb(1) == 255);
  CHECK(srgb(2) == 255);
  CHECK(srgb(0.21404114f) == 128);  // code 0.5 by IEC 61966-2-1, rounded up
  CHECK(srgb(0.0031308f) == 10);
}

TEST_CASE("the colour bar darkens from end to end") {
  double last = 1;
  for (int k = 0; k <= 100; ++k) {
    const Light c = bar_colour(k / 100.0);
    const double luminance = 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z;
    CHECK(luminance < last);
    last = luminance;
  }
  CHECK(length(bar_colour(-1) - bar_colour(0)) == 0);
  CHECK(length(bar_colour(7) - bar_colour(1)) == 0);
}

}  // namespace gonogo::report
