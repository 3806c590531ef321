#include "pipeline/report/picture/unfolded.h"

#include <algorithm>
#include <cmath>

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

}  // namespace gonogo::report
