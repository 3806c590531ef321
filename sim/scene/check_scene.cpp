#include "sim/scene/check_scene.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/format.h"
#include "sim/constraint/find_contacts.h"
#include "sim/constraint/joint_rows.h"

namespace gonogo::sim {
namespace {

std::string number(double x, int digits = 6) { return line("%.*g", digits, x); }

template <class V>
std::string text_of(const V& v) {
  return "(" + number(v.x) + ", " + number(v.y) + ", " + number(v.z) + ")";
}

void require(bool good, const std::string& sentence) {
  if (!good) throw InputError(sentence);
}

/// `sentence` is called when it is needed: worlds have many bodies, and making a sentence takes longer than checking
/// one.
template <class Sentence>
requires std::is_invocable_v<Sentence>
void require(bool good, const Sentence& sentence) {
  if (!good) throw InputError(sentence());
}

template <class V, class Name>
void require_finite(const V& v, const Name& name) {
  require(is_finite(v), [&] { return name() + " is " + text_of(v) + "; it must be finite"; });
}

bool at_least_zero(const Vec3& v) { return v.x >= 0 && v.y >= 0 && v.z >= 0 && is_finite(v); }

template <class Name>
void check_body(const BodyState& s, const BodyMass& m, const Name& name) {
  require(at_least_zero(m.inverse_mass), [&] {
    return name() + " has the inverse mass " + text_of(m.inverse_mass) +
           " 1/kg; masses must be above zero, and an inverse of 0 means fixed";
  });
  require(at_least_zero(m.inverse_inertia_B), [&] {
    return name() + " has the inverse moments of inertia " + text_of(m.inverse_inertia_B) +
           " 1/(kg m^2); moments must be above zero, and an inverse of 0 means that it does not turn";
  });
  require_finite(s.position, [&] { return name() + ": its position"; });
  require_finite(s.velocity, [&] { return name() + ": its velocity"; });
  require_finite(s.angular_velocity, [&] { return name() + ": its angular velocity"; });
  const Quat& q = s.orientation;
  const double norm = double(q.w) * q.w + double(q.x) * q.x + double(q.y) * q.y + double(q.z) * q.z;
  require(std::fabs(norm - 1) < 1e-3, [&] {
    return name() + ": the square of its orientation is " + number(norm) + ", it must be a unit quaternion";
  });
}

void check_law(const PairLaw& law, const std::string& what) {
  const std::pair<const char*, Real> parts[] = {
      {"friction", law.friction},          {"rolling friction", law.rolling_friction},
      {"cohesion", law.cohesion_pressure}, {"spinning friction", law.spinning_friction},
      {"stiffness", law.stiffness},        {"damping", law.damping}};
  for (const auto& [name, value] : parts)
    require(value >= 0 && std::isfinite(value),
            what + "the " + name + " is " + number(value) + "; it must be at least 0");
}

}  // namespace

void check_bodies(const SceneWorld& world, std::size_t w) {
  const std::string place = "world " + std::to_string(w) + ": ";
  require(world.mass.size() == world.body.size(), place + "has " + std::to_string(world.body.size()) + " bodies and " +
                                                      std::to_string(world.mass.size()) +
                                                      " masses; give every body one, by add_body");
  require_finite(world.gravity, [&] { return place + "gravity"; });
  require_finite(world.origin, [&] { return place + "the corner of the domain"; });
  for (std::size_t b = 0; b < world.body.size(); ++b)
    check_body(world.body[b], world.mass[b], [&] { return place + "body " + std::to_string(b); });
  for (int a = 0; a < kMaxMaterials; ++a)
    for (int b = 0; b < kMaxMaterials; ++b)
      check_law(world.law[a][b], place + "materials " + std::to_string(a) + " and " + std::to_string(b) + ": ");
}

void check_settings(const StepSettings& s) {
  require(s.step > 0 && std::isfinite(s.step), "the step is " + number(s.step) + " s; it must be above zero");
  require(s.iterations >= 1,
          "the solver's iterations are " + std::to_string(s.iterations) + "; at least one is needed");
  require(s.substeps >= 1, "the substeps are " + std::to_string(s.substeps) + "; at least one is needed");
  require(s.sort_every >= 1,
          "bodies are sorted every " + std::to_string(s.sort_every) + " steps; at least one is needed");
  require(s.max_slowed >= 0,
          "bodies may be slowed " + std::to_string(s.max_slowed) + " times; the number must be at least 0");
  const std::pair<const char*, Real> parts[] = {
      {"tolerance", s.tolerance},           {"envelope", s.envelope},
      {"recovery speed", s.recovery_speed}, {"recovery share", s.recovery_share},
      {"cohesion range", s.cohesion_range}, {"give", s.give}};
  for (const auto& [name, value] : parts)
    require(value >= 0 && std::isfinite(value),
            std::string("the ") + name + " of the step settings is " + number(value) + "; it must be at least 0");
  require(s.give_share > 0 && s.give_share <= 1,
          "the give share is " + number(s.give_share) + "; it must be above 0, at most 1");
  require(s.recovery_share <= 1, "the recovery share is " + number(s.recovery_share) + "; at most 1 is possible");
}

namespace {

std::string description(const Shape& s, std::size_t index) {
  return std::string(name_of(s.type)) + " (shape " + std::to_string(index) + ", body " + std::to_string(s.body) + ")";
}

// A name is made when a sentence needs it: worlds have many shapes, and making one takes longer than checking.
template <class Name>
void check_size(const Shape& s, const Name& name) {
  const int sizes[] = {1, 2, 3, 2, 3, 2, 0, 0, 0};  // numbers above zero that a type needs, in the order of ShapeType
  const Real size[] = {s.size.x, s.size.y, s.size.z};
  for (int k = 0; k < sizes[int(s.type)]; ++k)
    require(size[k] > 0 && std::isfinite(size[k]),
            [&] { return name() + " has the size " + number(size[k]) + " m; sizes must be above zero"; });
  if (s.type != ShapeType::wheel) return;
  require(s.lug_count >= 0 && s.lug_count <= 1000,
          [&] { return name() + " has " + std::to_string(s.lug_count) + " lugs; from 0 to 1000 are possible"; });
  require(s.lug_count == 0 || (s.size.z > 0 && s.size.z < s.size.x && s.lug_thickness > 0), [&] {
    return name() + " has lugs " + number(s.size.z) + " m high and " + number(s.lug_thickness) +
           " m thick; both must be above zero, the height below the radius";
  });
}

template <class Name>
void check_shape(const Shape& s, const Name& name) {
  if (s.material < 0 || s.material >= kMaxMaterials)
    throw InputError(name() + ": a shape's material is out of range: " + std::to_string(s.material) +
                     ", allowed 0 to " + std::to_string(kMaxMaterials - 1));
  const Quat& q = s.turn_B;
  const Real norm = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
  if (!(std::fabs(norm - 1) < Real(1e-3)))
    throw InputError(name() + ": the square of its orientation turn_B is " + number(norm) +
                     ", it must be a unit quaternion");
  check_size(s, name);
}

template <class Name>
void check_surface_index(const SceneWorld& world, const Shape& s, const Name& name) {
  const bool mesh = s.type == ShapeType::mesh;
  if (!mesh && s.type != ShapeType::heightfield) return;
  const std::size_t count = mesh ? world.mesh.size() : world.heightfield.size();
  if (s.surface < 0 || std::size_t(s.surface) >= count)
    throw InputError(name() + " refers to number " + std::to_string(s.surface) + " of the world's " +
                     (mesh ? "meshes" : "heightfields") + ", which has " + std::to_string(count) +
                     "; they are counted from 0");
}

}  // namespace

const char* name_of(ShapeType type) {
  constexpr const char* names[] = {"sphere", "capsule", "ellipsoid", "cylinder",    "box",
                                   "wheel",  "mesh",    "plane",     "heightfield", "empty place"};
  static_assert(std::size(names) == kShapeTypes + 1);
  return names[int(type)];
}

void check_shapes(const SceneWorld& world, std::size_t w) {
  const std::string place = "world " + std::to_string(w) + ": ";
  for (std::size_t i = 0; i < world.shape.size(); ++i) {
    const Shape& s = world.shape[i];
    const auto name = [&] { return place + "the " + description(s, i); };
    check_shape(s, name);
    check_surface_index(world, s, name);
  }
}

void set_surface_sizes(SceneWorld& world) {
  for (Shape& s : world.shape) {
    if (s.type == ShapeType::mesh) s.size = {reach_of(*world.mesh[s.surface]), min_half_of(*world.mesh[s.surface]), 0};
    if (s.type == ShapeType::heightfield) s.size = {reach_of(*world.heightfield[s.surface]), 0, 0};
  }
}

namespace {

class MechanismChecker {
 public:
  MechanismChecker(const SceneWorld& world, const std::string& where) : world_(world), where_(where) {}

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
              "an axis has length " + number(length(v), 4) + "; it must be a unit vector");
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

  /// The nearest image of a body is the one that is meant.
  void check_length(double length) const {
    for (const auto& [repeats, period] :
         {std::pair{world_.periodic_x, world_.size.x}, {world_.periodic_y, world_.size.y}})
      require(!repeats || 2 * length < period, "its length is " + number(length, 4) +
                                                   " m; in a world that repeats every " + number(period, 4) +
                                                   " m it must be below half of that");
  }

  void check(const Joint& j) const {
    check_pair(j.a, j.b);
    require(j.type != JointType::distance || j.length > 1e-6,
            "its length is " + number(j.length, 4) + " m; a distance joint needs one above 1e-6 m, or be spherical");
    if (j.type == JointType::distance) check_length(j.length);
    const Link l = link(j.a, j.b);
    const bool holds_axis =
        j.type == JointType::revolute || j.type == JointType::prismatic || j.type == JointType::fixed;
    const bool holds_side = j.type == JointType::prismatic || j.type == JointType::fixed;
    require(!holds_axis || dot(l.a.axis, l.b.axis) > 0, "the axes of its bodies point in opposite directions");
    require(!holds_side || dot(l.a.side, l.b.side) > 0, "the sides of its bodies point in opposite directions");
    for (Index k = 0; k < row_count(j.type); ++k) {
      const RowGeometry g = joint_row(j.type, l, j.length, k);
      require(std::fabs(g.error) <= kMaxStartError,
              "its bodies disagree by " + number(std::fabs(g.error), 4) +
                  (length(g.linear) > 0 ? " m at the start" : " rad at the start") +
                  "; at most 0.001 is allowed, place them where the joint holds them");
    }
  }

  void check(const SpringDamper& s) const {
    check_pair(s.a, s.b);
    require(s.stiffness >= 0 && std::isfinite(s.stiffness),
            "its stiffness is " + number(s.stiffness, 4) + "; it must be at least 0");
    require(s.damping >= 0 && std::isfinite(s.damping),
            "its damping is " + number(s.damping, 4) + "; it must be at least 0");
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
            "its axis has length " + number(length(m.axis_B), 4) + "; it must be a unit vector");
    const Vec3 axis_W = m.b == kWorld ? m.axis_B : rotate(world_.body[m.b].orientation, m.axis_B);
    require(can_turn(m.a, axis_W) || can_turn(m.b, axis_W), "neither of its bodies can turn about its axis");
    require(m.max_torque >= 0 && std::isfinite(m.max_torque),
            "its largest torque is " + number(m.max_torque, 4) + " N m; it must be at least 0");
    require(std::isfinite(m.target), "its speed or torque is not a number");
  }

  const SceneWorld& world_;
  const std::string& where_;
  std::string name_;
};

}  // namespace

void check_mechanisms(const SceneWorld& world, const std::string& where) { MechanismChecker(world, where).check(); }

namespace {

/// The name of a shape with its body as the scene counts it.
std::string described(const FlatWorld& flat, ShapeIndex i) {
  const Shape& s = flat.shape[i];
  const auto at = std::find(flat.place_of_body.begin(), flat.place_of_body.end(), s.body);
  return std::string(name_of(s.type)) + " of body " + std::to_string(at - flat.place_of_body.begin());
}

std::string in_world(WorldIndex w) { return "world " + std::to_string(w) + ": "; }

/// A world by itself, ready for the broad phase.
State<Cpu> state_of(const FlatWorld& flat) {
  State<Cpu> s;
  SurfaceLibrary library;
  std::vector<Shape> shape = flat.shape;
  for (Shape& each : shape) {
    if (each.type == ShapeType::mesh) each.surface = library.add(flat.mesh[each.surface]);
    if (each.type == ShapeType::heightfield) each.surface = library.add(flat.heightfield[each.surface]);
  }
  std::vector<Vec3d> position;
  std::vector<Quat> orientation;
  for (const BodyState& b : flat.body) {
    position.push_back(b.position);
    orientation.push_back(b.orientation);
  }
  s.surfaces.upload(library);
  s.position.upload(position);
  s.orientation.upload(orientation);
  s.mass.upload(flat.mass);
  s.world.upload({flat.world});
  s.world_of_body.upload(std::vector<WorldIndex>(flat.body.size()));
  s.shape.upload(shape);
  s.bin_of_shape.upload(flat.bin_of_shape);
  s.large.upload(flat.large);
  s.mechanisms.body.upload(flat.mechanisms.body);
  s.world_count = 1;
  s.body_count = Index(flat.body.size());
  s.shape_count = Index(shape.size());
  s.bin_count = flat.size().bins;
  s.solids_binned = true;
  reserve_search(s, Index(flat.large.size()));
  reserve_contacts(s, std::max<Index>(4 * s.shape_count, 1));
  return s;
}

void refuse_overlap(const FlatWorld& flat, WorldIndex w, ShapeIndex i, ShapeIndex j, Real overlap, Real allowed) {
  throw InputError(in_world(w) + "the " + described(flat, i) + " and the " + described(flat, j) + " overlap by " +
                   number(overlap, 3) + " m, at most " + number(allowed, 3) +
                   " m are allowed at the start; move them apart or raise the world's overlap_limit");
}

}  // namespace

void check_pairs(const FlatWorld& flat, WorldIndex w) {
  State<Cpu> s;
  s.shape.upload(flat.shape);
  s.mass.upload(flat.mass);
  s.mechanisms.body.upload(flat.mechanisms.body);
  ContactFinder find{};
  find.shape = s.shape.view();
  find.mass = s.mass.view();
  find.jointed = s.mechanisms.body.view();
  std::vector<ShapeIndex> of_type[kShapeTypes];
  for (std::size_t i = 0; i < flat.shape.size(); ++i) of_type[int(flat.shape[i].type)].push_back(ShapeIndex(i));
  for (int a = 0; a < kShapeTypes; ++a)
    for (int b = a; b < kShapeTypes; ++b) {
      if (have_routine(ShapeType(a), ShapeType(b))) continue;
      for (const ShapeIndex i : of_type[a])
        for (const ShapeIndex j : of_type[b])
          if (find.may_touch(i, j))
            throw InputError(in_world(w) + "the " + described(flat, i) + " may meet the " + described(flat, j) +
                             ", and contacts between these two are not implemented; give them one group when they "
                             "should not touch, or use other shapes");
    }
}

void check_overlaps(const FlatWorld& flat, WorldIndex w, const StepSettings& settings, Real limit) {
  State<Cpu> s = state_of(flat);
  const Cpu exec{1};
  sort_into_bins(exec, s);
  StepSettings rigid = settings;
  rigid.give = 0;  // with give a deep overlap counts for less
  find_contacts(exec, s, rigid);
  for (ContactIndex k = 0; k < *contact_count(s).count; ++k) {
    const auto [i, j] = s.pair.read(k);
    const Real gap = s.contact.read(k).gap, a = smallest_half(flat.shape[i]), b = smallest_half(flat.shape[j]);
    const Real allowed = limit * (a > 0 && b > 0 ? std::min(a, b) : std::max(a, b));
    if (gap < -allowed) refuse_overlap(flat, w, i, j, -gap, allowed);
  }
}

}  // namespace gonogo::sim
