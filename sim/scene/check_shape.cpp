#include "sim/scene/check_shape.h"

#include <cmath>
#include <cstdio>
#include <iterator>
#include <string>

#include "base/error.h"

namespace gonogo::sim {
namespace {

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%g", x);
  return text;
}

std::string description(const Shape& s, std::size_t index) {
  return std::string(name_of(s.type)) + " (shape " + std::to_string(index) + ", body " + std::to_string(s.body) + ")";
}

// A name is made when a sentence needs it: worlds have many shapes, and making one takes longer than checking.
template <class Name>
void check_size(const Shape& s, const Name& name) {
  const int sizes[] = {1, 2, 3, 2, 3, 2, 0, 0, 0};  // numbers above zero that a type needs, in the order of ShapeType
  const Real size[] = {s.size.x, s.size.y, s.size.z};
  for (int k = 0; k < sizes[int(s.type)]; ++k)
    if (!(size[k] > 0) || !std::isfinite(size[k]))
      throw InputError(name() + " has the size " + number(size[k]) + " m; sizes must be above zero");
  if (s.type != ShapeType::wheel) return;
  if (s.lug_count < 0 || s.lug_count > 1000)
    throw InputError(name() + " has " + std::to_string(s.lug_count) + " lugs; from 0 to 1000 are possible");
  if (s.lug_count > 0 && !(s.size.z > 0 && s.size.z < s.size.x && s.lug_thickness > 0))
    throw InputError(name() + " has lugs " + number(s.size.z) + " m high and " + number(s.lug_thickness) +
                     " m thick; both must be above zero, the height below the radius");
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

}  // namespace gonogo::sim
