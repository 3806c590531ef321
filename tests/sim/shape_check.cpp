// Shapes that a scene may not ask for are refused by a sentence that names them.
#include "sim/scene/check_scene.h"

#include <limits>

#include "sim/shape/meshes.h"
#include "sim/shape/touch/pairs.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/scenes.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

Shape valid(ShapeType type) {
  Shape s;
  s.type = type;
  s.size = {0.3f, 0.2f, 0.05f};
  s.lug_count = type == ShapeType::wheel ? 6 : 0;
  s.lug_thickness = 0.02f;
  return s;
}

SceneWorld world_with(const Shape& a, const Shape& b, bool moving = true) {
  SceneWorld w;
  for (Shape s : {a, b}) {
    s.body = w.add_body({{0.4 * double(w.body.size()), 0, 0}, {}, {}, {}},
                        moving || w.body.empty() ? solid(1, {1, 1, 1}) : fixed_body());
    w.add_shape(s);
  }
  return w;
}

std::string refusal(const SceneWorld& w) {
  return input_error([&] { make_simulation(Backend::cpu, {w}, {}, 1); });
}

}  // namespace

TEST_CASE("sizes, lugs, materials and orientations out of range are refused") {
  Shape s = valid(ShapeType::box);
  s.size.y = 0;
  CHECK(contains(refusal(world_with(s, valid(ShapeType::sphere))), "box (shape 0, body 0) has the size 0 m"));
  s.size.y = -1;
  CHECK(contains(refusal(world_with(s, valid(ShapeType::sphere))), "has the size -1 m"));
  s.size.y = std::numeric_limits<Real>::quiet_NaN();
  CHECK(contains(refusal(world_with(s, valid(ShapeType::sphere))), "has the size nan m"));
  s = valid(ShapeType::capsule);
  s.size.x = 0;
  CHECK(contains(refusal(world_with(valid(ShapeType::sphere), s)), "capsule (shape 1, body 1) has the size 0 m"));
  s = valid(ShapeType::wheel);
  s.lug_count = -1;
  CHECK(contains(refusal(world_with(valid(ShapeType::sphere), s)), "has -1 lugs"));
  s = valid(ShapeType::wheel);
  s.lug_thickness = 0;
  CHECK(contains(refusal(world_with(valid(ShapeType::sphere), s)), "0 m thick"));
  s = valid(ShapeType::sphere);
  s.material = kMaxMaterials;
  CHECK(contains(refusal(world_with(s, s)), "material is out of range: 4"));
  s = valid(ShapeType::sphere);
  s.turn_B = {0.5f, 0, 0, 0};
  CHECK(contains(refusal(world_with(s, s)), "unit quaternion"));
}

TEST_CASE("every two types of shape may meet but two of the ground, which are refused by name unless they never meet") {
  for (const ShapeType type : {ShapeType::plane, ShapeType::heightfield}) {
    Shape plane = valid(ShapeType::plane), ground = valid(type);
    const auto world = [&](bool moving) {
      SceneWorld w = world_with(plane, ground, moving);
      if (type == ShapeType::heightfield) {
        Heightfield f;
        f.nx = f.ny = 2;
        f.spacing_x = f.spacing_y = 1;
        f.height = {0, 0, 0, 0};
        w.shape[1].surface = w.add_heightfield(f);
      }
      return w;
    };
    CHECK(contains(refusal(world(true)), "world 0: the plane of body 0 may meet the " + std::string(name_of(type)) +
                                             " of body 1, and contacts between these two are not implemented"));
    SceneWorld both_fixed = world(false);
    both_fixed.mass[0] = fixed_body();
    CHECK(refusal(both_fixed).empty());
    plane.group = ground.group = 3;
    CHECK(refusal(world(true)).empty());
    ground.group = 2;
    CHECK(!refusal(world(true)).empty());
  }
  const ShapeType solids[] = {ShapeType::sphere, ShapeType::capsule, ShapeType::ellipsoid, ShapeType::cylinder,
                              ShapeType::box,    ShapeType::wheel,   ShapeType::mesh};
  for (const ShapeType a : solids)
    for (const ShapeType b : solids) {
      SceneWorld w = world_with(valid(a), valid(b));
      for (Shape& s : w.shape)
        if (s.type == ShapeType::mesh) s.surface = w.add_mesh(box_mesh({0.1f, 0.1f, 0.1f}));
      CHECK(refusal(w).empty());
    }
}

TEST_CASE("shapes of one group pass through each other; others do not") {
  for (const Backend backend : backends())
    for (const int group : {0, 2}) {
      Shape a = valid(ShapeType::box), b = valid(ShapeType::box);
      a.group = b.group = group;
      SceneWorld w = world_with(a, b);
      w.gravity = {};
      const auto simulation = simulate(backend, w, {});
      simulation->advance(1);
      CHECK(simulation->contacts(0).empty() == (group != 0));
    }
}

TEST_CASE("a mesh or heightfield that is missing or bad is refused") {
  Shape mesh = valid(ShapeType::mesh), field = valid(ShapeType::heightfield);
  mesh.surface = 0;
  CHECK(contains(refusal(world_with(mesh, valid(ShapeType::sphere))),
                 "refers to number 0 of the world's meshes, which has 0"));
  field.surface = -1;
  CHECK(contains(refusal(world_with(valid(ShapeType::sphere), field)), "number -1 of the world's heightfields"));
  SceneWorld w;
  Heightfield f;
  f.name = "hill";
  CHECK(contains(input_error([&] { w.add_heightfield(f); }), "heightfield \"hill\": it has 0 by 0 heights"));
  f.nx = f.ny = 2;
  CHECK(contains(input_error([&] { w.add_heightfield(f); }), "spacing must be above zero"));
  f.spacing_x = f.spacing_y = 1;
  CHECK(contains(input_error([&] { w.add_heightfield(f); }), "it has 0 heights"));
  f.height = {0, 1, 2, std::numeric_limits<Real>::infinity()};
  CHECK(contains(input_error([&] { w.add_heightfield(f); }), "height 3 is not finite"));
  CHECK(contains(input_error([&] { w.add_mesh({}); }), "it is empty"));
}

TEST_CASE("an overlapping start is refused when the scene asks, naming the bodies, the overlap and the limit") {
  SceneWorld w;
  w.origin = {-1, -1, -1};
  w.size = {2, 2, 2};
  add_plane(w);
  w.add_sphere({0, 0, 0.09}, 0.1f, 1000, 0);     // 10 % of its radius in the plane
  w.add_sphere({0.185, 0, 0.1}, 0.1f, 1000, 0);  // 14.6 mm in the other
  add_box(w, {{0, 0.5, 0.1}, {}, {}, {}}, {0.1f, 0.1f, 0.1f}, 1);
  CHECK(refusal(w).empty());
  w.overlap_limit = 0.2f;
  CHECK(refusal(w).empty());
  w.overlap_limit = 0.12f;
  const std::string said = refusal(w);
  CHECK(contains(said, "world 0: the sphere of body "));
  CHECK((contains(said, "body 1 and") && contains(said, "body 2 ")) == contains(said, "of body 2"));
  CHECK(contains(said, "overlap by 0.0147 m, at most 0.012 m are allowed"));
  StepSettings soft;
  soft.give = 0.6f;  // the whole overlap counts here, see counted_gap
  CHECK(input_error([&] { make_simulation(Backend::cpu, {w}, soft, 1); }) == said);
  w.overlap_limit = 0.05f;
  w.body[2].position.x = 0.5;
  CHECK(contains(refusal(w), "the sphere of body 1 and the plane of body 0 overlap by 0.01 m, at most 0.005 m"));
  // Through a periodic side.
  w.periodic_x = true;
  w.body[1].position = {-0.95, 0, 0.5};
  w.body[2].position = {0.9, 0, 0.5};
  CHECK(contains(refusal(w), "overlap by 0.05 m"));
}
