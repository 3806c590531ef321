#include "sim/scene/check_joint.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/error.h"
#include "sim/joint/row.h"

namespace gonogo::sim {
namespace {

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", x);
  return text;
}

class Checker {
 public:
  Checker(const SceneWorld& world, const std::string& where) : world_(world), where_(where) {}

  void check() {
    for (std::size_t i = 0; i < world_.joint.size(); ++i) {
      name_ = "joint " + std::to_string(i);
      check(world_.joint[i]);
    }
    for (std::size_t i = 0; i < world_.spring.size(); ++i) {
      name_ = "spring " + std::to_string(i);
      check(world_.spring[i]);
    }
    for (std::size_t i = 0; i < world_.motor.size(); ++i) {
      name_ = "motor " + std::to_string(i);
      check(world_.motor[i]);
    }
  }

 private:
  void require(bool good, const std::string& sentence) const {
    if (!good) throw InputError(where_ + name_ + ": " + sentence);
  }

  void check_body(BodyIndex b) const {
    require(b >= 0 && b < BodyIndex(world_.body.size()), "body " + std::to_string(b) + " is not among the world's " +
                                                             std::to_string(world_.body.size()) + " bodies");
  }

  void check_directions(const Attachment& at) const {
    for (const Vec3& v : {at.axis_B, at.side_B})
      require(std::fabs(length(v) - 1) < 1e-3f,
              "an axis has length " + number(length(v)) + "; it must be a unit vector");
    require(std::fabs(dot(at.axis_B, at.side_B)) < 1e-3f, "a side direction is not at right angles to its axis");
  }

  void check_pair(const Attachment& a, const Attachment& b) const {
    check_body(a.body);
    check_body(b.body);
    require(a.body != b.body, "it holds body " + std::to_string(a.body) + " to itself; give two bodies");
    require(!is_fixed(world_.mass[a.body]) || !is_fixed(world_.mass[b.body]),
            "bodies " + std::to_string(a.body) + " and " + std::to_string(b.body) +
                " are both fixed; at least one must be able to move");
    check_directions(a);
    check_directions(b);
  }

  Link link(const Attachment& a, const Attachment& b) const {
    const BodyState &at_a = world_.body[a.body], &at_b = world_.body[b.body];
    Link l{placed(a, at_a.orientation), placed(b, at_b.orientation), {}};
    l.offset = at_a.position + l.a.arm - at_b.position - l.b.arm;
    if (world_.periodic_x) l.offset.x = std::remainder(l.offset.x, world_.size.x);
    if (world_.periodic_y) l.offset.y = std::remainder(l.offset.y, world_.size.y);
    return l;
  }

  void check(const Joint& j) const {
    check_pair(j.a, j.b);
    require(j.type != JointType::distance || j.length > 1e-6,
            "its length is " + number(j.length) + " m; a distance joint needs one above 1e-6 m, or be spherical");
    const Link l = link(j.a, j.b);
    const bool holds_axis =
        j.type == JointType::revolute || j.type == JointType::prismatic || j.type == JointType::fixed;
    const bool holds_side = j.type == JointType::prismatic || j.type == JointType::fixed;
    require(!holds_axis || dot(l.a.axis, l.b.axis) > 0, "the axes of its bodies point in opposite directions");
    require(!holds_side || dot(l.a.side, l.b.side) > 0, "the sides of its bodies point in opposite directions");
    for (Index k = 0; k < row_count(j.type); ++k) {
      const RowGeometry g = joint_row(j.type, l, j.length, k);
      require(std::fabs(g.error) <= kMaxStartError,
              "its bodies disagree by " + number(std::fabs(g.error)) +
                  (length(g.linear) > 0 ? " m at the start" : " rad at the start") +
                  "; at most 0.001 is allowed, place them where the joint holds them");
    }
  }

  void check(const SpringDamper& s) const {
    check_pair(s.a, s.b);
    require(s.stiffness >= 0 && std::isfinite(s.stiffness),
            "its stiffness is " + number(s.stiffness) + "; it must be at least 0");
    require(s.damping >= 0 && std::isfinite(s.damping),
            "its damping is " + number(s.damping) + "; it must be at least 0");
    require(std::isfinite(s.free_length), "its free length is not a number");
    const ForceTable& t = s.table;
    require(t.count == 0 || (t.count >= 2 && t.count <= kMaxTablePoints),
            "its table has " + std::to_string(t.count) + " points; give 2 to " + std::to_string(kMaxTablePoints));
    for (int k = 1; k < t.count; ++k)
      require(t.stretch[k] > t.stretch[k - 1] && t.force[k] >= t.force[k - 1],
              "its table must ascend in stretch and never fall in force, as it does at point " + std::to_string(k));
  }

  bool can_turn(BodyIndex b, const Vec3& axis_W) const {
    if (b == kWorld) return false;
    const Vec3 axis = rotate_back(world_.body[b].orientation, axis_W);
    return dot(scale(axis, axis), world_.mass[b].inverse_inertia_B) > 0;
  }

  void check(const Motor& m) const {
    check_body(m.a);
    if (m.b != kWorld) check_body(m.b);
    require(m.a != m.b, "it turns body " + std::to_string(m.a) + " against itself; give two bodies, or kWorld as b");
    require(std::fabs(length(m.axis_B) - 1) < 1e-3f,
            "its axis has length " + number(length(m.axis_B)) + "; it must be a unit vector");
    const Vec3 axis_W = m.b == kWorld ? m.axis_B : rotate(world_.body[m.b].orientation, m.axis_B);
    require(can_turn(m.a, axis_W) || can_turn(m.b, axis_W), "neither of its bodies can turn about its axis");
    require(m.max_torque >= 0 && std::isfinite(m.max_torque),
            "its largest torque is " + number(m.max_torque) + " N m; it must be at least 0");
    require(std::isfinite(m.target), "its speed or torque is not a number");
  }

  const SceneWorld& world_;
  const std::string& where_;
  std::string name_;
};

}  // namespace

void check_mechanisms(const SceneWorld& world, const std::string& where) { Checker(world, where).check(); }

}  // namespace gonogo::sim
