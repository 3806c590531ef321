// The ring of a tyre against closed forms: beams, sidewalls, air, modes; and its tangent against differences.
#include <numbers>
#include <random>

#include "sim/elastic/tyre/press.h"
#include "sim/elastic/tyre/ring.h"
#include "sim/elastic/tyre/tyre.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"

namespace {

using namespace gonogo;
using namespace gonogo::sim::elastic;

Tyre car_tyre() {
  return {.radius = 0.31,
          .tread = 0.01,
          .rim_radius = 0.19,
          .width = 0.15,
          .bulge = 0.03,
          .pressure = 2e5,
          .bending = 3,
          .stretching = 2e6,
          .radial = 1e5,
          .tangential = 4e5,
          .belt_mass = 7,
          .nodes = 120,
          .law = penalty_law(3e8, 0.5, 0.1)};
}

/// A thin ring of radius 0.3 m that hardly stretches, held by next to nothing.
Tyre bare_ring(int nodes) {
  Tyre t = car_tyre();
  t.tread = 0;
  t.radius = 0.3;
  t.bulge = t.pressure = 0;
  t.stretching = 1e8;
  t.radial = t.tangential = 0.1;
  t.nodes = nodes;
  return t;
}

Vector shaken(const Ring& ring, const Rim& rim, double by) {
  std::mt19937 draw(11);
  std::uniform_real_distribution<double> step(-1, 1);
  Vector u = ring.unloaded(rim);
  for (int k = 0; k < ring.nodes(); ++k)
    u.segment<3>(3L * k) += by * Eigen::Vector3d{step(draw), step(draw), 20 * step(draw)};
  return u;
}

struct Found {
  Vector force;
  RimLoad rim;
  double energy = 0;
};

Found found_at(const Ring& ring, const Vector& u, const Rim& rim) {
  Found f;
  RingShape shape;
  ring.measure(u, rim, shape);
  f.force = Vector::Zero(ring.dofs());
  f.rim = ring.add_forces(u, shape, shape.strain, f.force);
  f.energy = ring.energy_of_air(shape);
  for (std::size_t i = 0; i < shape.strain.size(); i += kStrains) f.energy += ring.square_of(&shape.strain[i]) / 2;
  return f;
}

}  // namespace

TEST_CASE("Rigid motion of ring and rim changes no force but its direction") {
  Tyre t = car_tyre();
  const Ring ring(t);
  const Rim still{}, moved{.x = 3, .y = -2, .turn = 7.3};
  const Vector u = shaken(ring, still, 1e-3);
  const Found before = found_at(ring, u, still);
  const double c = std::cos(moved.turn), s = std::sin(moved.turn);
  Vector v = u;
  for (int k = 0; k < ring.nodes(); ++k)
    v.segment<3>(3L * k) << moved.x + c * u[3L * k] - s * u[3L * k + 1], moved.y + s * u[3L * k] + c * u[3L * k + 1],
        u[3L * k + 2] + moved.turn;
  const Found after = found_at(ring, v, moved);
  double worst = 0;
  for (int k = 0; k < ring.nodes(); ++k) {
    const double fx = c * before.force[3L * k] - s * before.force[3L * k + 1],
                 fy = s * before.force[3L * k] + c * before.force[3L * k + 1];
    worst = std::max({worst, std::fabs(fx - after.force[3L * k]), std::fabs(fy - after.force[3L * k + 1]),
                      std::fabs(before.force[3L * k + 2] - after.force[3L * k + 2])});
  }
  CHECK(worst < 1e-9 * before.force.norm());

  t.pressure = t.bulge = 0;
  const Ring empty(t);
  const Found none = found_at(empty, empty.unloaded(moved), moved);
  CHECK(none.force.norm() < 1e-12 * t.stretching);
}

TEST_CASE("Forces of ring and air are minus the slopes of their energy, and balance on the rim") {
  const Ring ring(car_tyre());
  const Rim rim{.x = 0.1, .y = 0.2, .turn = 0.4};
  const Vector u = shaken(ring, rim, 5e-4);
  const Found here = found_at(ring, u, rim);
  for (const int i : {0, 1, 2, 30, 31, 32, 358}) {
    const double h = 1e-6;
    Vector a = u, b = u;
    a[i] -= h;
    b[i] += h;
    const double slope = (found_at(ring, b, rim).energy - found_at(ring, a, rim).energy) / (2 * h);
    CHECK(here.force[i] == Approx(-slope).epsilon(1e-5).margin(1e-3));
  }
  Rim more = rim, less = rim;
  more.turn += 1e-6;
  less.turn -= 1e-6;
  const double slope = (found_at(ring, u, more).energy - found_at(ring, u, less).energy) / 2e-6;
  CHECK(here.rim.moment == Approx(-slope).epsilon(1e-5).margin(1e-3));
  double x = here.rim.x, y = here.rim.y, moment = here.rim.moment;
  for (int k = 0; k < ring.nodes(); ++k) {
    const double fx = here.force[3L * k], fy = here.force[3L * k + 1];
    x += fx;
    y += fy;
    moment += (u[3L * k] - rim.x) * fy - (u[3L * k + 1] - rim.y) * fx + here.force[3L * k + 2];
  }
  CHECK(std::fabs(x) + std::fabs(y) < 1e-9 * here.force.norm());
  CHECK(std::fabs(moment) < 1e-9 * here.force.norm());
}

TEST_CASE("The ring's tangents are the slopes of its forces") {
  const Ring ring(car_tyre());
  const Rim rim{.y = 0.306, .turn = 0.2};
  const Vector u = shaken(ring, rim, 5e-4);
  std::mt19937 draw(3);
  std::uniform_real_distribution<double> any(-1, 1);
  Vector v(ring.dofs()), way(ring.dofs());
  for (int i = 0; i < ring.dofs(); ++i) {
    v[i] = 0.1 * any(draw);
    way[i] = any(draw);
  }
  const std::vector<RigidShape> ground{RigidShape{},
                                       {.kind = RigidKind::ball, .point = {0.1, -0.2, 0}, .radius = 0.25}};
  const auto forces = [&](const Vector& at, const Vector& speed, bool by_velocity, Triplets* tangent) {
    Found f = found_at(ring, at, rim);
    if (by_velocity) f.force.setZero();
    std::vector<ContactPoint> points;
    ring.add_contact(at, {.ground = ground, .v = speed, .by_velocity = by_velocity}, f.force, tangent, points);
    int touching = 0;
    for (const ContactPoint& p : points) touching += p.touch != Touch::open;
    CHECK(touching > 4);
    return f.force;
  };
  for (const bool by_velocity : {false, true}) {
    Triplets tangent;
    forces(u, v, by_velocity, &tangent);
    if (!by_velocity) ring.add_tangent(u, rim, 1, tangent);
    Eigen::SparseMatrix<double> k(ring.dofs(), ring.dofs());
    k.setFromTriplets(tangent.begin(), tangent.end());
    const double h = 1e-7;
    const Vector more = by_velocity ? forces(u, v + h * way, true, nullptr) : forces(u + h * way, v, false, nullptr),
                 less = by_velocity ? forces(u, v - h * way, true, nullptr) : forces(u - h * way, v, false, nullptr);
    const Vector slope = (less - more) / (2 * h), expected = k * way;
    CHECK((slope - expected).norm() < 1e-5 * expected.norm());
  }
}

TEST_CASE("A pinched thin ring gives way by 0.149 F R^3 / EI") {
  // Timoshenko, Strength of materials, part 1, section 80: (pi / 4 - 2 / pi) along the forces, (2 / pi - 1 / 2) across.
  for (const int nodes : {96, 192}) {
    const Tyre t = bare_ring(nodes);
    PressedTyre ring(t, 1, {});
    const double force = 0.01, unit = force * std::pow(0.3, 3) / t.bending;
    REQUIRE(ring.pull({{nodes / 4, 0, -force}, {3 * nodes / 4, 0, force}}));
    const double along = 0.6 - (ring.node(nodes / 4).y - ring.node(3 * nodes / 4).y);
    const double across = ring.node(0).x - ring.node(nodes / 2).x - 0.6;
    CHECK(along / unit == Approx(std::numbers::pi / 4 - 2 / std::numbers::pi).epsilon(2e-3 * 96 / nodes));
    CHECK(across / unit == Approx(2 / std::numbers::pi - 0.5).epsilon(2e-3 * 96 / nodes));
  }
}

TEST_CASE("A free ring bends in its plane at n^2 (n^2 - 1)^2 / (n^2 + 1) EI / (rho A R^4)") {
  Tyre t = bare_ring(180);  // Love 1927, section 293
  t.belt_mass = 7;
  const std::vector<double> f = frequencies(t);
  const double line_mass = t.belt_mass / (2 * std::numbers::pi * 0.3),
               scale = t.bending / (line_mass * std::pow(0.3, 4));
  for (int n = 2; n <= 5; ++n) {
    const double square = n * n * std::pow(n * n - 1, 2) / (n * n + 1) * scale;
    const double expected = std::sqrt(square) / (2 * std::numbers::pi);
    CHECK(f[std::size_t(2 * n - 1)] == Approx(expected).epsilon(3e-3));  // after 3 rigid motions, in pairs
    CHECK(f[std::size_t(2 * n)] == Approx(expected).epsilon(3e-3));
  }
}

TEST_CASE("Air widens a ring by p b / (EA / R^2 + k_r)") {
  Tyre t = bare_ring(240);
  t.bulge = 0;
  t.pressure = 1e4;
  t.stretching = 1e6;
  t.radial = 2e6;
  t.tangential = 1e5;
  const PressedTyre ring(t, 0, {});
  const double w = t.pressure * t.width / (t.stretching / 0.09 + t.radial);
  CHECK(ring.node(0).x - 0.3 == Approx(w).epsilon(1e-3));
}

TEST_CASE("A membrane keeps its length, and pulls by the air over the area that its chord cuts off") {
  const Membrane m(0.11, 0.03, 2e5);
  const double r = (0.11 * 0.11 / 4 + 0.03 * 0.03) / 0.06;
  CHECK(m.length() == Approx(2 * r * std::asin(0.055 / r)));
  CHECK(m.at(0.11).force == Approx(2e5 * (r - 0.03)));  // p r cos t, and r cos t = r - bulge
  for (const double c : {0.02, 0.06, 0.08, 0.11, 0.12, 0.1285, 0.135}) {
    const double h = 1e-6;
    const Pull here = m.at(c), less = m.at(c - h), more = m.at(c + h);
    CHECK(here.force == Approx((more.energy - less.energy) / (2 * h)).epsilon(1e-6).margin(1e-3));
    CHECK(here.stiffness == Approx((more.force - less.force) / (2 * h)).epsilon(1e-6));
  }
}

TEST_CASE("The belt as a rigid ring has the sidewalls' stiffness in closed form") {
  Tyre t = car_tyre();
  t.stretching = 1e9;  // or the air would widen the belt
  const SidewallStiffness k = sidewall_stiffness(t);
  const double big = t.belt_radius(), c = big - t.rim_radius;
  const Pull pull = Membrane(c, t.bulge, t.pressure).at(c);
  const double shift = std::numbers::pi * big * (t.radial + t.tangential + 2 * pull.stiffness + 2 * pull.force / c);
  const double turn = 2 * std::numbers::pi * big * (t.tangential * big * big + 2 * pull.force * t.rim_radius * big / c);
  CHECK(k.shift == Approx(shift).epsilon(1e-3));
  CHECK(k.turn == Approx(turn).epsilon(1e-3));
}

TEST_CASE("A balloon between two plates carries p b times the length that touches") {
  // Without bending, stretch and sidewalls: two half circles of radius H / 2 and two flat sides, so that
  //   F = p b pi (R - H / 2)
  Tyre t = bare_ring(720);
  t.pressure = 1e5;
  t.stretching = 1e8;
  t.bending = 0.02;
  t.radial = t.tangential = 2;
  t.law = penalty_law(1e10, 0, 1e-3);
  double close = 0;
  std::vector<RigidShape> plates{{.point = {0, -0.301, 0},
                                  .axis = {0, 1, 0},
                                  .displacement =
                                      [&](double) {
                                        return Vec3d{0, close, 0};
                                      }},
                                 {.point = {0, 0.301, 0}, .axis = {0, -1, 0}, .displacement = [&](double) {
                                    return Vec3d{0, -close, 0};
                                  }}};
  PressedTyre ring(t, 0, plates);
  while (close < 0.0405) {
    close += 5e-4;
    REQUIRE(ring.settle());
  }
  double below = 0;
  for (const ContactPoint& p : ring.points()) below += std::max(p.normal.y, 0.0) * p.pressure * p.area;
  const double gap = 0.602 - 2 * close, expected = t.pressure * t.width * std::numbers::pi * (0.3 - gap / 2);
  CHECK(below == Approx(expected).epsilon(0.01));
  CHECK(below / (t.width * ring.contact_length() / 2) == Approx(t.pressure).epsilon(0.02));
}

TEST_CASE("Every fault of a tyre gets a sentence") {
  const auto message = [](auto change) {
    Tyre t = car_tyre();
    change(t);
    return input_error([&] { check_tyre(t); });
  };
  CHECK(message([](Tyre& t) { t.bending = 0; }) ==
        "tyre: bending stiffness of the belt is 0 N m^2; it must be above 0");
  CHECK(message([](Tyre& t) { t.rim_radius = 0.3; }) ==
        "tyre: the rim's radius is 0.3 m; it must lie between 0 and the belt's radius, 0.3 m");
  CHECK(message([](Tyre& t) { t.bulge = 0.06; }) ==
        "tyre: the sidewall's bulge is 0.06 m; allowed is 0 to half its height, 0.055 m");
  CHECK(message([](Tyre& t) { t.radial = -1; }) ==
        "tyre: radial stiffness of the sidewalls is -1 N/m^2; it must be 0 or above");
  CHECK(message([](Tyre& t) { t.loss = 0.5; }) == "tyre: the loss factor is 0.5; allowed is 0 to 0.3");
  CHECK(message([](Tyre& t) { t.nodes = 3; }) == "tyre: the ring has 3 nodes; allowed are 24 to 10000");
  CHECK(message([](Tyre& t) { t.law.c_n = 0; }).find("tread: stiffness c_n is 0") == 0);
}
