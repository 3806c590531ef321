// How far bodies are from what a joint holds, written from the joints' definitions and not from the engine's rows.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/scene/scene.h"
#include "sim/state/mechanism.h"

namespace gonogo::test {

/// Position and rotation matrix (columns: body axes in the world) in double.
struct Pose {
  Vec3d position, x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};

  Vec3d direction(const Vec3& v) const { return x * double(v.x) + y * double(v.y) + z * double(v.z); }
  Vec3d point(const Vec3& p) const { return position + direction(p); }
};

inline Pose pose_of(const sim::BodyState& s) {
  const double w = s.orientation.w, a = s.orientation.x, b = s.orientation.y, c = s.orientation.z;
  const double n = 1 / (w * w + a * a + b * b + c * c);
  return {s.position,
          {(w * w + a * a - b * b - c * c) * n, 2 * (a * b + w * c) * n, 2 * (a * c - w * b) * n},
          {2 * (a * b - w * c) * n, (w * w - a * a + b * b - c * c) * n, 2 * (b * c + w * a) * n},
          {2 * (a * c + w * b) * n, 2 * (b * c - w * a) * n, (w * w - a * a - b * b + c * c) * n}};
}

/// What a joint holds at zero [m] and [-]; small angles in radians.
inline std::vector<double> constraints(const sim::Joint& j, const Pose& a, const Pose& b) {
  using sim::JointType;
  const Vec3d gap = a.point(j.a.point_B) - b.point(j.b.point_B);
  const Vec3d axis_a = a.direction(j.a.axis_B), side_a = a.direction(j.a.side_B);
  const Vec3d axis_b = b.direction(j.b.axis_B), side_b = b.direction(j.b.side_B), third_b = cross(axis_b, side_b);
  if (j.type == JointType::distance) return {length(gap) - j.length};
  if (j.type == JointType::equal_spin) return {};  // it holds speeds alone
  std::vector<double> held;
  if (j.type == JointType::prismatic || j.type == JointType::in_line)
    held = {dot(gap, side_b), dot(gap, third_b)};
  else
    held = {gap.x, gap.y, gap.z};
  if (j.type == JointType::universal) held.push_back(dot(axis_a, axis_b));
  if (j.type == JointType::revolute || j.type == JointType::prismatic || j.type == JointType::fixed) {
    held.push_back(dot(axis_a, side_b));
    held.push_back(dot(axis_a, third_b));
  }
  if (j.type == JointType::prismatic || j.type == JointType::fixed) held.push_back(dot(side_a, third_b));
  return held;
}

/// What a spring measures.
inline double measured(const sim::SpringDamper& s, const Pose& a, const Pose& b) {
  const Vec3d gap = a.point(s.a.point_B) - b.point(s.b.point_B);
  const Vec3d axis = b.direction(s.b.axis_B), side_a = a.direction(s.a.side_B), side_b = b.direction(s.b.side_B);
  if (s.kind == sim::SpringKind::linear) return length(gap);
  if (s.kind == sim::SpringKind::axial) return dot(gap, axis);
  return std::atan2(dot(side_a, cross(axis, side_b)), dot(side_a, side_b));
}

/// Largest error of a world's joints [m, rad].
inline double drift(const sim::SceneWorld& world, const std::vector<sim::BodyState>& body) {
  double worst = 0;
  for (const sim::Joint& j : world.joint)
    for (const double error : constraints(j, pose_of(body[j.a.body]), pose_of(body[j.b.body])))
      worst = std::max(worst, std::fabs(error));
  return worst;
}

}  // namespace gonogo::test
