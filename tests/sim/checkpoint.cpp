// Checkpoint files: what continues from one has the bits of what was never interrupted; anything else is refused.
#include "sim/io/checkpoint.h"

#include <cstring>
#include <fstream>

#include "base/error.h"
#include "base/files/file.h"
#include "sim/scene/scene.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/refused.h"
#include "tests/support/same_bits.h"
#include "tests/support/scenes.h"
#include "tests/support/temporary_folder.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

/// Loose grains with friction, rolling and cohesion under a wheel with motor and spring.
SceneWorld busy_world() {
  Draw draw(77);
  SceneWorld w;
  w.size = {0.5, 0.5, 1.5};
  w.origin = {0, 0, -0.1};
  w.periodic_x = true;
  w.set_law(0, 0, {Real(0.5), Real(0.1), 300});
  w.set_law(0, 1, {Real(0.7), 0, 0});
  add_plane(w);
  for (int x = 0; x < 5; ++x)
    for (int y = 0; y < 4; ++y)
      for (int z = 0; z < 3; ++z)
        w.add_sphere(Vec3d{x + 0.5, y + 1.0, z + 0.5} * 0.095 + draw.direction() * 0.002, 0.045f, 2600, 0);
  sim::Shape s;
  s.type = ShapeType::wheel;
  s.material = 1;
  s.size = {0.15f, 0.08f, 0.02f};
  s.lug_count = 12;
  s.lug_thickness = 0.02f;
  s.body = w.add_body({{0.25, 0.25, 0.46}, {}, {}, {}}, solid(10, {1, 0.2f, 1}));
  w.add_shape(s);
  const BodyIndex mass = w.add_body({{0.25, 0.25, 0.9}, {}, {}, {}}, solid(20, {1, 1, 1}));
  w.motor.push_back(speed_motor(w, s.body, kWorld, {0, 1, 0}, 3, 100));
  w.spring.push_back(
      spring_along(w, s.body, mass, w.body[s.body].position, w.body[mass].position, {0, 0, -1}, 20000, 800));
  w.force.push_back(aerodynamic_drag(mass, 1.2, 1, 2));
  Monitor m;
  m.body = s.body;
  m.motor = 0;
  m.time_limit = 0.06;
  w.monitor.push_back(m);
  return w;
}

/// A velocity controller whose limit changes at `time` [s].
Controller braked(double time) {
  Controller c;
  c.type = ControllerType::velocity_by_torque;
  c.command = {{0, 1}};
  c.limit = {{time, 100}, {time + 1, 50}};
  c.integral = 70;
  return c;
}

StepSettings settings() {
  StepSettings s;
  s.iterations = 15;
  return s;
}

Snapshot after(Index steps) {
  const auto simulation = simulate(Backend::cpu, busy_world(), settings());
  simulation->advance(steps);
  return simulation->snapshot(0);
}

void overwrite(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

}  // namespace

TEST_CASE("a simulation that goes on from a checkpoint file has the bits of an uninterrupted one") {
  for (const Backend backend : backends()) {
    const TemporaryFolder folder;
    const SceneWorld w = busy_world();
    const std::string scene = scene_hash(w, settings());
    const auto through = simulate(backend, w, settings());
    through->advance(40);
    through->set_gravity(0, {1, 0, -9});  // changed during the run: part of the state
    through->set_motor(0, 0, 6, 50);
    save_checkpoint(folder / "run.h5", through->snapshot(0), scene);
    through->advance(40);

    const auto resumed = simulate(backend, busy_world(), settings());
    resumed->restore(0, load_checkpoint(folder / "run.h5", scene_hash(busy_world(), settings())));
    resumed->advance(40);
    INFO(name_of(backend));
    CHECK(through->report(0).contact_count > 50);
    CHECK(same_bits(through->bodies(0), resumed->bodies(0)));
    CHECK(through->report(0).time == resumed->report(0).time);
    CHECK(through->motor_torque(0, 0) == resumed->motor_torque(0, 0));
    CHECK(through->stop(0).step == 60);
    CHECK(resumed->stop(0).step == 60);
  }
}

TEST_CASE("integrals of controllers, monitors and their records go through a checkpoint file") {
  for (const Backend backend : backends()) {
    const TemporaryFolder folder;
    SceneWorld w = busy_world();
    w.controller.push_back(braked(0));
    w.controller[0].body = w.monitor[0].body;
    const auto through = simulate(backend, w, settings());
    through->advance(40);
    save_checkpoint(folder / "run.h5", through->snapshot(0), "scene");
    const auto resumed = simulate(backend, w, settings());
    resumed->restore(0, load_checkpoint(folder / "run.h5", "scene"));
    for (const auto& s : {through.get(), resumed.get()}) s->advance(40);
    const MonitorState a = through->monitor(0, 0), b = resumed->monitor(0, 0);
    INFO(name_of(backend));
    CHECK(same_bits(through->bodies(0), resumed->bodies(0)));
    CHECK(std::memcmp(&a, &b, sizeof a) == 0);
    CHECK(through->stop(0).cause == StopCause::time_limit);
    CHECK(resumed->stop(0).cause == StopCause::time_limit);
    CHECK(a.sample_count == 60);
    const auto all = through->samples(0, 0, 0, 60), again = resumed->samples(0, 0, 0, 60);
    CHECK(std::memcmp(all.data(), again.data(), 60 * sizeof(MonitorSample)) == 0);
  }
}

TEST_CASE("saving what was loaded gives the same bytes") {
  const TemporaryFolder folder;
  save_checkpoint(folder / "a.h5", after(10), "scene");
  save_checkpoint(folder / "b.h5", load_checkpoint(folder / "a.h5", "scene"), "scene");
  CHECK(read_file(folder / "a.h5") == read_file(folder / "b.h5"));
}

TEST_CASE("every part of scene and numerics counts in the scene's hash") {
  const SceneWorld w = busy_world();
  const StepSettings s = settings();
  std::vector<std::pair<SceneWorld, StepSettings>> variants(21, {w, s});
  variants[1].first.gravity.x = 0.1f;
  variants[2].first.set_law(0, 1, {Real(0.71), 0, 0});
  variants[3].first.body[7].position.z += 1e-12;
  variants[4].first.mass[7].inverse_mass.x *= 1.01f;
  variants[5].first.shape[7].size.x *= 1.0001f;
  variants[6].first.shape.back().lug_count = 11;
  variants[7].first.motor[0].max_torque = 99;
  variants[8].first.spring[0].damping = 801;
  variants[9].second.iterations = 16;
  variants[10].second.step = 2e-3f;
  variants[11].first.periodic_y = true;
  variants[12].second.target = Target::coulomb;
  variants[13].first.joint.push_back(spherical(w, 1, 2, {0, 0, 0}));
  variants[14].first.spring[0].table = force_table({{0, 0}, {1, 1}});
  variants[15].first.force[0].wind.y = 1;
  variants[16].first.monitor[0].distance = 9;
  variants[17].first.controller.push_back(braked(0));
  variants[18].first.controller.push_back(braked(1));
  variants[19].second.substeps = 2;
  variants[20].second.give = 0.6f;
  std::vector<std::string> hashes;
  for (const auto& [scene, numerics] : variants) hashes.push_back(scene_hash(scene, numerics));
  CHECK(hashes[0] == scene_hash(busy_world(), settings()));
  StepSettings other_share = s;
  other_share.give_share = 0.5f;
  CHECK(hashes[0] == scene_hash(w, other_share));  // no contact gives
  other_share.give = 0.6f;
  CHECK(hashes[20] != scene_hash(w, other_share));
  std::sort(hashes.begin(), hashes.end());
  CHECK(std::unique(hashes.begin(), hashes.end()) == hashes.end());
}

TEST_CASE("a checkpoint of another scene, a foreign file and a missing one are refused with what to do") {
  const TemporaryFolder folder;
  const auto path = folder / "run.h5";
  save_checkpoint(path, after(2), "scene");
  refused([&] { load_checkpoint(path, "other"); }, "another scene");
  refused([&] { load_checkpoint(folder / "none.h5", "scene"); }, "no such file");
  Hdf5Writer foreign;
  foreign.array("weights", std::vector<double>{1, 2});
  foreign.save(folder / "foreign.h5");
  refused([&] { load_checkpoint(folder / "foreign.h5", "scene"); }, "no checkpoint");
  overwrite(folder / "text.h5", "not HDF5 at all");
  refused([&] { load_checkpoint(folder / "text.h5", "scene"); }, "text.h5");
}

TEST_CASE("a checkpoint cut off anywhere in its content is refused") {
  const TemporaryFolder folder;
  save_checkpoint(folder / "run.h5", after(2), "scene");
  const std::string bytes = read_file(folder / "run.h5");
  const std::size_t content = bytes.rfind("\ngonogo seal");  // a cut seal alone takes no content away
  REQUIRE(content < bytes.size());
  for (std::size_t keep = 0; keep < content; keep += content / 37) {
    overwrite(folder / "cut.h5", bytes.substr(0, keep));
    refused([&] { load_checkpoint(folder / "cut.h5", "scene"); }, "cut.h5");
  }
}

TEST_CASE("one flipped bit is refused, also when the seal at the file's end was cut away with it") {
  const TemporaryFolder folder;
  const Snapshot good = after(2);
  save_checkpoint(folder / "run.h5", good, "scene");
  const std::string bytes = read_file(folder / "run.h5");
  const std::size_t content = bytes.rfind("\ngonogo seal");
  REQUIRE(content < bytes.size());
  for (std::size_t at = 0; at < content; at += content / 61) {
    std::string altered = bytes;
    altered[at] = char(altered[at] ^ 4);
    overwrite(folder / "altered.h5", altered);
    refused([&] { load_checkpoint(folder / "altered.h5", "scene"); }, "altered.h5");
  }
  // A position changed by someone who also removes the seal: the content's own hash tells.
  const std::string place(reinterpret_cast<const char*>(&good.position[20]), sizeof(Vec3d));
  const auto found = bytes.find(place);
  REQUIRE(found != std::string::npos);
  std::string altered = bytes.substr(0, content);
  altered[found + 3] = char(altered[found + 3] ^ 1);
  overwrite(folder / "altered.h5", altered);
  refused([&] { load_checkpoint(folder / "altered.h5", "scene"); }, "altered");
}
