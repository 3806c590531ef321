#include "pipeline/report/picture/model.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/math/random.h"

namespace gonogo::report {
namespace {

using sim::BodyIndex;

/// Places `next` at the image in which the joint's points are nearest to each other.
void place_beside(const sim::SceneWorld& world, const sim::Attachment& from, const sim::Attachment& next,
                  std::vector<sim::BodyState>& body) {
  const sim::BodyState& at = body[std::size_t(from.body)];
  sim::BodyState& moved = body[std::size_t(next.body)];
  const Vec3d apart = moved.position + rotate_precisely(moved.orientation, next.point_B) - at.position -
                      rotate_precisely(at.orientation, from.point_B);
  if (world.periodic_x) moved.position.x += std::remainder(apart.x, world.size.x) - apart.x;
  if (world.periodic_y) moved.position.y += std::remainder(apart.y, world.size.y) - apart.y;
}

/// Half of what a shape takes across when its axle lies across [m].
double half_width(const sim::Shape& s) {
  const bool known = s.type == sim::ShapeType::wheel || s.type == sim::ShapeType::cylinder ||
                     s.type == sim::ShapeType::box || s.type == sim::ShapeType::ellipsoid;
  return known ? double(s.size.y) : double(s.size.x);
}

}  // namespace

Unfolded unfolded(const sim::SceneWorld& world, const sim::Capture& frame, BodyIndex focus) {
  Unfolded u{frame.body, std::vector<bool>(frame.body.size()), 1};
  if (focus < 0) return u;
  u.beside[std::size_t(focus)] = true;
  const auto moves = [&](BodyIndex b) { return !sim::is_fixed(world.mass[std::size_t(b)]); };
  for (bool more = true; more;) {
    more = false;
    for (const sim::Joint& j : world.joint) {
      const bool a = u.beside[std::size_t(j.a.body)], b = u.beside[std::size_t(j.b.body)];
      if (a == b || !moves(j.a.body) || !moves(j.b.body)) continue;
      place_beside(world, a ? j.a : j.b, a ? j.b : j.a, u.body);
      u.beside[std::size_t(a ? j.b.body : j.a.body)] = more = true;
    }
  }
  if (!world.periodic_y) return u;
  double reach = 0;
  for (const sim::Shape& s : world.shape)
    if (u.beside[std::size_t(s.body)]) {
      const double y = sim::centre_of(s, u.body[std::size_t(s.body)]).y;
      reach = std::max(reach, std::fabs(y - u.body[std::size_t(focus)].position.y) + half_width(s));
    }
  u.copies = 1 + 2 * int(std::ceil(std::max(0.0, reach / world.size.y - 0.5)));
  return u;
}

namespace {

using sim::BodyState;
using sim::SceneWorld;
using sim::Shape;
using sim::ShapeType;

// Linear light, not sRGB.
constexpr Light kRubber{0.022f, 0.022f, 0.024f}, kRim{0.42f, 0.43f, 0.44f}, kHole{0.03f, 0.03f, 0.035f},
    kSteel{0.30f, 0.33f, 0.37f}, kBase{0.20f, 0.17f, 0.14f}, kGround{0.40f, 0.38f, 0.35f};

/// Turns places of a world into the level frame around the focus.
class Placement {
 public:
  Placement(const SceneWorld& world, const sim::Capture& frame, sim::BodyIndex focus) : world_(world) {
    origin_ = world.origin + world.size * 0.5;
    if (focus >= 0) {
      if (world.periodic_x) origin_.x = frame.body[focus].position.x;
      if (world.periodic_y) origin_.y = frame.body[focus].position.y;
    }
    origin_.z = 0;
    const Real g = length(world.gravity);
    z_ = g > 0 ? world.gravity * (-1 / g) : Vec3{0, 0, 1};
    const Vec3 forward{1, 0, 0}, level = forward - z_ * dot(forward, z_);
    x_ = length(level) > 1e-3f ? level * (1 / length(level)) : Vec3{0, 0, -1};
    y_ = cross(z_, x_);
  }

  Vec3 turned(const Vec3& v) const { return {dot(v, x_), dot(v, y_), dot(v, z_)}; }

  /// Nearest image about the focus along periodic axes.
  Vec3 placed(const Vec3d& p) const {
    Vec3d d = p - origin_;
    if (world_.periodic_x) d.x = std::remainder(d.x, world_.size.x);
    if (world_.periodic_y) d.y = std::remainder(d.y, world_.size.y);
    return turned(static_cast<Vec3>(d));
  }
  /// Level place of one that has been put beside the focus already.
  Vec3 held(const Vec3d& p) const { return turned(static_cast<Vec3>(p - origin_)); }
  /// Level place of one given from the focus in axes of the world.
  Vec3 beside_focus(const Vec3d& d) const { return turned(static_cast<Vec3>(d)); }

 private:
  const SceneWorld& world_;
  Vec3d origin_;
  Vec3 x_, y_, z_;  // axes of the level frame in the world's
};

bool moves(const SceneWorld& world, sim::BodyIndex b) { return !sim::is_fixed(world.mass[b]); }

/// Grains differ a little in brightness, so that each is seen.
Light varied(const Light& colour, std::uint64_t index) { return colour * Real(0.86 + 0.28 * random_unit(7, 0, index)); }

Light ball_colour(const SceneWorld& world, const BodyState& body, const Shape& shape, const ModelStyle& style) {
  if (!moves(world, shape.body)) return kBase;
  if (style.colour == GrainColour::material) return material_colour(shape.material);
  const double value = style.colour == GrainColour::speed ? length(sim::velocity_of(shape, body))
                                                          : sim::centre_of(shape, body).z + shape.size.x;
  return bar_colour((value - style.low) / std::max(1e-12, style.high - style.low));
}

/// A pose in the level frame.
struct Pose {
  const Placement& place;
  Vec3 centre;
  Quat orientation;
  Vec3 point(const Vec3& p) const { return centre + direction(p); }
  Vec3 direction(const Vec3& v) const { return place.turned(rotate(orientation, v)); }
};

void add_surface(Model& model, const sim::Surface& s, const Pose& pose, const Light& colour) {
  for (const auto& t : s.triangle) {
    Face f;
    for (int k = 0; k < 3; ++k) {
      f.corner[k] = pose.point(s.point[t[k]]);
      f.normal[k] = pose.direction(s.normal[t[k]]);
    }
    f.colour = colour;
    model.face.push_back(f);
  }
}

/// Disc across the wheel's axle on one side of it, `side` +1 or -1.
void add_disc(Model& model, const Pose& pose, const Vec3& middle, Real radius, Real side, const Light& colour) {
  constexpr int segments = 40;
  const auto corner = [&](int k) {
    const Real angle = Real(6.283185307) * Real(k) / segments;
    return middle + Vec3{radius * std::cos(angle), 0, radius * std::sin(angle)};
  };
  for (int k = 0; k < segments; ++k) {
    Face f{{pose.point(middle), pose.point(corner(k)), pose.point(corner(k + 1))}, {}, colour};
    for (Vec3& n : f.normal) n = pose.direction({0, side, 0});
    model.face.push_back(f);
  }
}

/// Decoration that shows how a wheel turns: a bright disc with five holes, a hair in front of its sides.
void add_rim(Model& model, const Shape& wheel, const Pose& pose) {
  const Real rim = Real(0.6) * wheel.size.x, hair = Real(0.002) * wheel.size.x;
  for (const Real side : {Real(1), Real(-1)}) {
    const auto middle = [&](int layer) { return Vec3{0, side * (wheel.size.y + Real(layer) * hair), 0}; };
    add_disc(model, pose, middle(1), rim, side, kRim);
    add_disc(model, pose, middle(2), Real(0.22) * rim, side, kHole);
    for (int k = 0; k < 5; ++k) {
      const Real angle = Real(6.283185307) * Real(k) / 5;
      const Vec3 off{Real(0.62) * rim * std::cos(angle), 0, Real(0.62) * rim * std::sin(angle)};
      add_disc(model, pose, middle(2) + off, Real(0.17) * rim, side, kHole);
    }
  }
}

void add_face(Model& model, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d, const Light& colour) {
  const Vec3 across = cross(b - a, d - a), n = across * (1 / length(across));
  model.face.push_back({{a, b, c}, {n, n, n}, colour});
  model.face.push_back({{a, c, d}, {n, n, n}, colour});
}

Real lowest_point(const Model& model) {
  Real low = std::numeric_limits<Real>::max();
  for (const Ball& b : model.ball) low = std::min(low, b.centre.z - b.radius);
  for (const Face& f : model.face)
    for (const Vec3& c : f.corner) low = std::min(low, c.z);
  return low;
}

/// The block of ground between a periodic bed, so many times as wide, and the floor, with upright sides.
void add_ground(Model& model, const SceneWorld& world, const Placement& place, double top, int copies) {
  const double x = world.size.x / 2, y = copies * world.size.y / 2;
  const Vec3d corner[4] = {{-x, -y, top}, {x, -y, top}, {x, y, top}, {-x, y, top}};
  Vec3 high[4], low[4];
  Real lowest = std::numeric_limits<Real>::max();
  for (int k = 0; k < 4; ++k) {
    high[k] = place.beside_focus(corner[k]);
    lowest = std::min(lowest, high[k].z);
  }
  model.floor = lowest - Real(0.04 * world.size.x);
  for (int k = 0; k < 4; ++k) low[k] = {high[k].x, high[k].y, model.floor};
  for (int k = 0; k < 4; ++k) add_face(model, low[k], low[(k + 1) % 4], high[(k + 1) % 4], high[k], kGround);
  add_face(model, high[0], high[1], high[2], high[3], kGround);
}

Light mixed(const Light& a, const Light& b, Real share) { return a * (1 - share) + b * share; }

}  // namespace

Light material_colour(int material) {
  constexpr Light colour[sim::kMaxMaterials] = {
      {0.66f, 0.50f, 0.30f}, {0.02f, 0.13f, 0.33f}, {0.60f, 0.10f, 0.03f}, {0.10f, 0.36f, 0.22f}};
  return colour[material];
}

Light bar_colour(double share) {
  // Sand at rest, then amber, vermilion and plum: darker with speed, and told apart by the colour-blind too.
  constexpr Light stop[] = {{0.66f, 0.50f, 0.30f},
                            {0.80f, 0.40f, 0.07f},
                            {0.68f, 0.14f, 0.04f},
                            {0.34f, 0.02f, 0.07f},
                            {0.10f, 0.005f, 0.10f}};
  const double at = std::clamp(std::isnan(share) ? 0.0 : share, 0.0, 1.0) * 4;
  const int first = std::min(3, int(at));
  return mixed(stop[first], stop[first + 1], Real(at - first));
}

Model model_of(const SceneWorld& world, const sim::Capture& frame, const ModelStyle& style) {
  const Placement place(world, frame, style.focus);
  const Unfolded shown = unfolded(world, frame, style.focus);
  Model model;
  double lowest_fixed = std::numeric_limits<double>::max();
  const auto detail = sim::SurfaceDetail{96, Real(std::max(world.size.x, world.size.y) / 2)};
  for (std::size_t i = 0; i < world.shape.size(); ++i) {
    const Shape& s = world.shape[i];
    const BodyState& body = shown.body[s.body];
    const Vec3d centre = sim::centre_of(s, body);
    const Vec3 middle = shown.beside[s.body] ? place.held(centre) : place.placed(centre);
    if (s.type == ShapeType::sphere) {
      // All lobes of a grain alike; of what is fixed, each by itself.
      const std::size_t own = moves(world, s.body) ? std::size_t(s.body) : i;
      const Light colour = varied(ball_colour(world, body, s, style), own);
      const int beside = shown.beside[s.body] ? 0 : shown.copies / 2;
      for (int k = -beside; k <= beside; ++k)
        model.ball.push_back({middle + place.beside_focus({0, k * world.size.y, 0}), s.size.x, colour});
      if (!moves(world, s.body)) lowest_fixed = std::min(lowest_fixed, centre.z);
      continue;
    }
    const Pose pose{place, middle, sim::shape_orientation(s, body.orientation)};
    const bool wheel = s.type == ShapeType::wheel;
    add_surface(model, sim::surface_of(world, s, detail), pose,
                wheel                  ? kRubber
                : moves(world, s.body) ? kSteel
                                       : kGround);
    if (wheel) add_rim(model, s, pose);
  }
  const bool bed = world.periodic_x && world.periodic_y && lowest_fixed < std::numeric_limits<double>::max();
  if (bed)
    add_ground(model, world, place, lowest_fixed, shown.copies);
  else
    model.floor = lowest_point(model);
  return model;
}

}  // namespace gonogo::report
