// VTK series read back by a reader of their own.
#include "sim/io/vtk_series.h"

#include <sys/resource.h>

#include <csignal>

#include "base/error.h"
#include "sim/shape/meshes.h"
#include "tests/support/backends.h"
#include "tests/support/catch.h"
#include "tests/support/scenes.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/vtp_file.h"

using namespace gonogo;
using namespace gonogo::sim;
using namespace gonogo::test;

namespace {

/// Plane, a body of two spheres that turns, a wheel and a box.
SceneWorld mixed_world() {
  SceneWorld w;
  w.origin = {-1, -1, -1};
  w.size = {4, 2, 3};
  w.set_law(0, 0, {Real(0.5), 0, 0});
  add_plane(w);
  w.add_sphere({0, 0, 0.0999}, 0.1f, 1000, 2);
  const BodyIndex pair = w.add_body({{1, 0, 1}, about_x(kPi / 2), {1, 0, 0}, {0, 0, 2}}, solid(2, {1, 1, 1}));
  for (const double side : {-0.25, 0.25}) {
    Shape s;
    s.body = pair;
    s.size = {0.1f, 0, 0};
    s.offset_B = {0, Real(side), 0};
    w.add_shape(s);
  }
  Shape wheel;
  wheel.type = ShapeType::wheel;
  wheel.size = {0.4f, 0.1f, 0.02f};
  wheel.lug_count = 8;
  wheel.lug_thickness = 0.03f;
  wheel.material = 1;
  wheel.body = w.add_body({{2, 0, 1}, about_y(0.3), {0, 0, 0}, {0, 5, 0}}, solid(20, {1, 1, 1}));
  w.add_shape(wheel);
  add_box(w, {{-0.5, 0, 1}, {}, {}, {}}, {0.1f, 0.2f, 0.3f}, 5);
  w.shape.back().turn_B = about_x(kPi / 2);  // its z axis along the body's y
  return w;
}

Vec3d row(const std::vector<double>& values, std::size_t i) {
  return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
}

}  // namespace

TEST_CASE("spheres are written with place, radius, motion, body and material") {
  const TemporaryFolder folder;
  const SceneWorld w = mixed_world();
  VtkSeries series(folder.path(), w);
  Capture frame{0.25, w.body, {}};
  series.write(frame);
  const VtpFile f = read_vtp(folder / "spheres_000000.vtp");
  REQUIRE(f.points == 3);
  CHECK(f.vertices == 3);
  CHECK(f.triangles == 0);
  CHECK(f.values("TimeValue") == std::vector<double>{0.25});
  CHECK(f.values("body") == std::vector<double>{1, 2, 2});
  CHECK(f.values("material") == std::vector<double>{2, 0, 0});
  CHECK(f.values("connectivity") == std::vector<double>{0, 1, 2});
  CHECK(f.values("offsets") == std::vector<double>{1, 2, 3});
  CHECK(row(f.values("Points"), 0).z == 0.0999);  // places keep double precision
  // The body was turned by 90 degrees about x: its y axis is the world's z.
  CHECK(length(row(f.values("Points"), 1) - Vec3d{1, 0, 0.75}) < 1e-6);
  CHECK(length(row(f.values("Points"), 2) - Vec3d{1, 0, 1.25}) < 1e-6);
  CHECK(f.values("radius")[2] == Approx(0.1));
  CHECK(length(row(f.values("velocity"), 1) - Vec3d{1, 0, 0}) < 1e-6);  // the spin's axis passes through it
  CHECK(f.values("speed")[1] == Approx(1));
  CHECK(row(f.values("angular_velocity"), 2).z == 2);
  CHECK(f.array.at("velocity").components == 3);
  CHECK(f.array.at("radius").type == "Float32");
}

TEST_CASE("other shapes are written as triangles that move with their bodies") {
  const TemporaryFolder folder;
  const SceneWorld w = mixed_world();
  VtkSeries series(folder.path(), w);
  series.write({0, w.body, {}});
  const VtpFile f = read_vtp(folder / "surfaces_000000.vtp");
  REQUIRE(f.points == 4 + (48 * 2 + 2 * 49 + 8 * 24) + 24);
  CHECK(f.triangles == 2 + (48 * 2 + 2 * 48 + 8 * 12) + 12);
  CHECK(f.vertices == 0);
  const auto &corner = f.values("connectivity"), &end = f.values("offsets");
  REQUIRE(corner.size() == std::size_t(3 * f.triangles));
  CHECK(end.back() == double(corner.size()));
  CHECK(*std::max_element(corner.begin(), corner.end()) == double(f.points - 1));
  const auto& body = f.values("body");
  for (std::size_t i = 0; i < body.size(); ++i) {
    const Vec3d p = row(f.values("Points"), i);
    if (body[i] == 0) CHECK(std::fabs(p.x) == 2);  // half of the longest edge of the world
    if (body[i] == 3) {
      const Vec3d arm = p - Vec3d{2, 0, 1}, speed = row(f.values("velocity"), i);
      CHECK(std::hypot(arm.x, arm.z) < 0.4207);
      CHECK(length(speed - cross(Vec3d{0, 5, 0}, arm)) < 1e-5);
    }
    if (body[i] == 4) {
      CHECK(std::fabs(std::fabs(p.y) - 0.3) < 1e-6);
      CHECK(std::fabs(std::fabs(p.z - 1) - 0.2) < 1e-6);
    }
  }
}

TEST_CASE("meshes and heightfields are written where they are in the world") {
  const TemporaryFolder folder;
  SceneWorld w;
  w.size = {2, 2, 2};
  Shape s;
  s.type = ShapeType::heightfield;
  s.surface = w.add_heightfield({"steps", 3, 2, 0.5f, 1, {0, 0.1f, 0.2f, 0.3f, 0.4f, 0.5f}});
  s.body = w.add_body({{1, 1, 0.25}, {}, {}, {}}, fixed_body());
  w.add_shape(s);
  s.type = ShapeType::mesh;
  s.surface = w.add_mesh(box_mesh({0.1f, 0.2f, 0.3f}));
  s.body = w.add_body({{1, 1, 1}, about_x(kPi / 2), {0, 0, 1}, {}}, solid(1, {1, 1, 1}));
  w.add_shape(s);
  VtkSeries series(folder.path(), w);
  series.write({0, w.body, {}});
  const VtpFile f = read_vtp(folder / "surfaces_000000.vtp");
  CHECK(f.triangles == 2 * 2 + 12);
  REQUIRE(f.points == 3 * f.triangles);
  for (std::size_t i = 0; i < std::size_t(f.points); ++i) {
    const Vec3d p = row(f.values("Points"), i);
    const bool ground = f.values("body")[i] == 0;
    CHECK(row(f.values("velocity"), i).z == (ground ? 0 : 1));
    if (ground) {  // z = 0.25 + 0.1 i + 0.3 j at x = 0.5 + 0.5 i, y = 0.5 + j
      CHECK(p.z == Approx(0.25 + 0.2 * (p.x - 0.5) + 0.3 * (p.y - 0.5)));
    } else {
      CHECK(std::fabs(std::fabs(p.x - 1) - 0.1) < 1e-6);
      CHECK(std::fabs(std::fabs(p.y - 1) - 0.3) < 1e-6);
      CHECK(std::fabs(std::fabs(p.z - 1) - 0.2) < 1e-6);
    }
  }
}

TEST_CASE("contacts are written with the force that carries a resting sphere and with their gap") {
  for (const Backend backend : backends()) {
    const TemporaryFolder folder;
    SceneWorld w;
    w.size = {2, 2, 2};
    w.origin = {-1, -1, -0.5};
    w.set_law(0, 0, {Real(0.5), 0, 0});
    add_plane(w);
    w.add_sphere({0.3, 0, 0.0999}, 0.1f, 1000, 0);
    const auto simulation = simulate(backend, w, {});
    VtkSeries series(folder.path(), w);
    series.write(capture_world(*simulation, 0));
    CHECK(read_vtp(folder / "contacts_000000.vtp").points == 0);  // no step taken yet
    simulation->advance(1);
    CHECK(simulation->contacts(0).at(0).gap == Approx(-1e-4).epsilon(1e-3));
    simulation->advance(299);
    series.write(capture_world(*simulation, 0));
    const VtpFile f = read_vtp(folder / "contacts_000001.vtp");
    REQUIRE(f.points == 1);
    const double weight = 1000 * 4.0 / 3 * kPi * 1e-3 * kGravity;
    CHECK(row(f.values("impulse"), 0).z == Approx(weight * 1e-3).epsilon(1e-3));
    CHECK(length(row(f.values("normal"), 0) - Vec3d{0, 0, 1}) < 1e-6);
    CHECK(length(row(f.values("Points"), 0) - Vec3d{0.3, 0, 0}) < 1e-4);
    CHECK(std::fabs(f.values("gap")[0]) < 1e-4);
    CHECK(f.values("body_a")[0] == 1);
    CHECK(f.values("body_b")[0] == 0);
    CHECK(read_pvd(folder / "contacts.pvd").back().first == Approx(0.3));
  }
}

TEST_CASE("contacts of a world in a batch are those of the world alone") {
  SceneWorld w;
  w.size = {2, 2, 2};
  w.origin = {-1, -1, -0.5};
  w.set_law(0, 0, {Real(0.5), 0, 0});
  add_plane(w);
  for (int i = 0; i < 3; ++i) w.add_sphere({0.19 * i, 0, 0.0999}, 0.1f, 1000, 0);
  SceneWorld other = w;
  other.add_sphere({0, 0.5, 0.0999}, 0.1f, 1000, 0);
  for (const Backend backend : backends()) {
    const auto alone = simulate(backend, w, {});
    const auto batch = make_simulation(backend, {other, w}, {}, 1);
    alone->advance(5);
    batch->advance(5);
    const Capture a = capture_world(*alone, 0), b = capture_world(*batch, 1);
    REQUIRE(a.contact.size() == 5);
    REQUIRE(b.contact.size() == 5);
    for (std::size_t i = 0; i < a.contact.size(); ++i) {
      CHECK(a.contact[i].a == b.contact[i].a);
      CHECK(a.contact[i].b == b.contact[i].b);
      CHECK(a.contact[i].gap == b.contact[i].gap);
      CHECK(length(a.contact[i].impulse - b.contact[i].impulse) == 0);
    }
  }
}

TEST_CASE("a series names its frames in order, and only those that are complete") {
  const TemporaryFolder folder;
  const SceneWorld w = mixed_world();
  {
    VtkSeries series(folder.path(), w);
    CHECK(read_pvd(folder / "spheres.pvd").empty());
    for (int k = 0; k < 3; ++k) {
      series.write({0.02 * k, w.body, {}});
      for (const char* kind : {"spheres", "surfaces", "contacts"}) {
        const auto frames = read_pvd(folder / (std::string(kind) + ".pvd"));
        REQUIRE(int(frames.size()) == k + 1);
        CHECK(frames.back().first == Approx(0.02 * k));
        for (const auto& [time, file] : frames) CHECK(read_vtp(folder / file).values("TimeValue")[0] == Approx(time));
      }
    }
    // A disk that takes no more: the frame fails, the series stays as it was.
    rlimit old{};
    ::getrlimit(RLIMIT_FSIZE, &old);
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit full{1000, old.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &full);
    CHECK_THROWS_AS(series.write({0.06, w.body, {}}), DeviceError);
    ::setrlimit(RLIMIT_FSIZE, &old);
  }
  CHECK(read_pvd(folder / "spheres.pvd").size() == 3);
  for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
    CHECK(entry.path().string().find(".partial-") == std::string::npos);
}
