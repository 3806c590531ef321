#include <gonogo/sim.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "tests/support/catch.h"

using namespace gonogo::api;

namespace {

constexpr double kG = 9.80665;

struct Folder {
  std::filesystem::path path = std::filesystem::temp_directory_path() / "gonogo_face_sim";
  Folder() { std::filesystem::create_directories(path); }
  ~Folder() { std::filesystem::remove_all(path); }
};

/// A sphere of 1 kg that falls on a floor.
World ball(double height) {
  World world({.size = {2, 2, 4}});
  world.add_floor(0);
  const double radius = 0.1, volume = 4.0 / 3 * 3.14159265358979 * std::pow(radius, 3);
  world.add_sphere({.position = {1, 1, height}}, radius, 1 / volume);
  return world;
}

}  // namespace

TEST_CASE("a ball of the face falls freely, and rests with its weight on the floor") {
  Simulation simulation({ball(3), ball(0.1)}, {.step = 1e-3});
  simulation.step(500);
  const BodyState falling = simulation.body(1, 0);
  CHECK(falling.position.z == Approx(3 - kG * 0.25 / 2).margin(0.01));
  CHECK(falling.velocity.z == Approx(-kG * 0.5).epsilon(1e-3));
  CHECK(simulation.contact_force(1, 1).z == Approx(kG).epsilon(0.01));
  REQUIRE(simulation.contacts(1).size() == 1);
  CHECK(std::abs(simulation.contacts(1)[0].normal.z) == Approx(1));
  CHECK(simulation.report(0).time == Approx(0.5));
  CHECK(simulation.report(0).fault.empty());
  CHECK(simulation.world_count() == 2);
}

TEST_CASE("a box of the face slides on a slope steeper than its friction, as Coulomb says") {
  World world({.size = {20, 2, 2}, .gravity = {kG * std::sin(0.5), 0, -kG * std::cos(0.5)}});
  world.add_floor(0);
  const int box = world.add_box({.position = {1, 1, 0.1}}, {0.2, 0.2, 0.1}, 1000, 1);
  world.set_law(0, 1, {.friction = 0.3});
  Simulation simulation({world});
  simulation.step(1000);
  CHECK(simulation.body(box).velocity.x == Approx(kG * (std::sin(0.5) - 0.3 * std::cos(0.5))).epsilon(0.02));
  simulation.set_law(0, 1, {.friction = 3});
  simulation.step(1500);
  CHECK(std::abs(simulation.body(box).velocity.x) < 0.01);
}

TEST_CASE("a world of the face goes on from a snapshot and from a checkpoint with the same bits") {
  const Folder folder;
  const auto file = folder.path / "ball.h5";
  Simulation simulation({ball(0.3)});
  simulation.step(50);
  const Snapshot kept = simulation.snapshot();
  simulation.save(file);
  simulation.step(300);
  const BodyState end = simulation.body(1);
  simulation.restore(kept);
  simulation.step(300);
  CHECK(simulation.body(1).position.z == end.position.z);
  Simulation other({ball(0.3)});
  other.load(file);
  other.step(300);
  CHECK(other.body(1).velocity.z == end.velocity.z);
  Simulation different({ball(0.4)});
  CHECK_THROWS_AS(different.load(file), InputError);
}

TEST_CASE("bodies of the face rest on heights and on a mesh, and go to ParaView") {
  const Folder folder;
  const auto stl = folder.path / "wedge.obj";
  {
    std::ofstream out(stl);  // a tetrahedron with its base at z = 0
    out << "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nv 0 0 0.5\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
  }
  World world({.origin = {-2, -2, -1}, .size = {4, 4, 4}});
  world.add_heights({0, 0, 0.2}, {.nx = 3, .ny = 3, .spacing = 2, .height = std::vector<double>(9, 0.1)});
  world.add_mesh({1.5, 1.5, 0.3}, stl, 0.1);
  const int ball = world.add_ellipsoid({.position = {-1, -1, 0.5}}, {0.1, 0.1, 0.2}, 1000);
  world.set_law(0, 0, {.friction = 0.5, .rolling_friction = 0.1});
  CHECK(world.body_count() == 3);
  Simulation simulation({world});
  VtkFrames frames(folder.path / "frames", world);
  for (int k = 0; k < 3; ++k) {
    simulation.step(400);
    frames.write(simulation);
  }
  CHECK(frames.count() == 3);
  CHECK(std::filesystem::exists(folder.path / "frames" / "surfaces.pvd"));
  CHECK(simulation.bodies().size() == 3);
  CHECK(simulation.body(ball).position.z > 0.3 + 0.09);
  CHECK(simulation.body(ball).position.z < 0.3 + 0.21);
  simulation.set_body(ball, {.position = {-1, -1, 1.5}});
  simulation.set_gravity({0, 0, 0});
  simulation.step(10);
  CHECK(simulation.body(ball).position.z == Approx(1.5));
}

TEST_CASE("the face refuses what does not exist, with a sentence") {
  World world = ball(1);
  CHECK_THROWS_AS(world.add_sphere({}, -1, 1000), InputError);
  CHECK_THROWS_AS(world.set_law(0, kMaterials, {}), InputError);
  CHECK_THROWS_AS(Simulation({}), InputError);
  Simulation simulation({world});
  CHECK_THROWS_WITH(simulation.body(7), "body 7: there are 2");
  CHECK_THROWS_AS(simulation.report(1), InputError);
  CHECK_THROWS_AS(simulation.set_motor(0, 1, 1), InputError);
  CHECK_THROWS_AS(simulation.step(-1), InputError);
  if (cuda_devices().empty()) CHECK_THROWS_AS(Simulation({world}, {.device = Device::cuda}), InputError);
  CHECK_FALSE(version().empty());
  CHECK_FALSE(revision().empty());
  CHECK_THROWS_AS(shipped("cars"), InputError);
}
