// Mobility indices against published values; traction and soil models against their limits, closed forms and
// hand-worked numbers.
#include <cmath>
#include <functional>

#include "base/units.h"
#include "tests/support/catch.h"
#include "tests/support/measure.h"
#include "tests/support/refused.h"
#include "tests/support/vehicles.h"
#include "vehicle/model/statics.h"
#include "vehicle/semi_empirical/bekker_wong.h"
#include "vehicle/semi_empirical/mobility_index.h"
#include "vehicle/semi_empirical/traction.h"

using namespace gonogo;
using namespace gonogo::test;
using namespace gonogo::vehicle;

namespace {

/// HMMWV tyres 37 x 12.5, more than 10 hp/ton, automatic.
WheeledIndexInput hmmwv(double pounds, double clearance_inches) {
  WheeledIndexInput in;
  in.axle_load = pounds * kPoundForce / 2;
  in.diameter = 37 * kInch;
  in.section_width = 12.5 * kInch;
  in.clearance = clearance_inches * kInch;
  in.power_per_mass = 50;
  return in;
}

/// LETE sand (Wong).
BekkerSoil lete_sand() {
  return {.n = 0.79,
          .k_c = 102e3,
          .k_phi = 5301e3,
          .cohesion = 1300,
          .friction_angle = 31.1 * kDegree,
          .shear_modulus = 0.012};
}

/// The regolith simulant and the wheel of Ishigami et al. 2007, their table 1.
BekkerSoil simulant() {
  return {.n = 1,
          .k_c = 1370,
          .k_phi = 8.14e5,
          .cohesion = 800,
          .friction_angle = 37.2 * kDegree,
          .shear_modulus = 0.03,
          .unit_weight = 1600 * kGravity};
}

/// Adaptive Simpson quadrature.
double quadrature(const std::function<double(double)>& f, double a, double b, int depth = 18) {
  const double m = 0.5 * (a + b), l = 0.5 * (a + m), r = 0.5 * (m + b);
  const double whole = (b - a) / 6 * (f(a) + 4 * f(m) + f(b));
  const double halves = (m - a) / 6 * (f(a) + 4 * f(l) + f(m)) + (b - m) / 6 * (f(m) + 4 * f(r) + f(b));
  if (depth == 0 || std::fabs(whole - halves) < 1e-9) return halves;
  return quadrature(f, a, m, depth - 1) + quadrature(f, m, b, depth - 1);
}

/// Ishigami's forces by his formulas in slip s_x = 1 - v_x / (r w) and slip angle, integrated on each side of the
/// largest stress. Written apart from the library: slip and angle as he has them, no shared code.
WheelForces by_quadrature(const BekkerSoil& soil, double r, double b, double s_x, double beta, double front) {
  const double largest = (0.4 + 0.2 * s_x) * front, k = soil.k_c / b + soil.k_phi,
               tan_phi = std::tan(soil.friction_angle);
  const auto sigma = [&](double t) {
    const double u = t < largest ? front - t * (front - largest) / largest : t;
    return k * std::pow(r, soil.n) * std::pow(std::max(0.0, std::cos(u) - std::cos(front)), soil.n);
  };
  const auto grown = [&](double j) {
    return j < 0 ? std::exp(j / soil.shear_modulus) - 1 : 1 - std::exp(-j / soil.shear_modulus);
  };
  const auto tau_x = [&](double t) {
    return (soil.cohesion + sigma(t) * tan_phi) * grown(r * (front - t - (1 - s_x) * (std::sin(front) - std::sin(t))));
  };
  const auto tau_y = [&](double t) {
    return (soil.cohesion + sigma(t) * tan_phi) * grown(r * (1 - s_x) * (front - t) * std::tan(beta));
  };
  const double x = (90 - soil.friction_angle / kDegree) / 2 * kDegree;
  const double d1 = 1 / std::tan(x) + std::tan(x + soil.friction_angle),
               d2 = 1 / std::tan(x) + std::pow(1 / std::tan(x), 2) * tan_phi;
  const auto bulldozed = [&](double t) {
    const double h = r * (std::cos(t) - std::cos(front));
    return d1 * (soil.cohesion * h + d2 * soil.unit_weight * h * h / 2) * (r - h * std::cos(t)) *
           (beta > 0   ? 1
            : beta < 0 ? -1
                       : 0);
  };
  const auto both = [&](const std::function<double(double)>& f) {
    return quadrature(f, 0, largest) + quadrature(f, largest, front);
  };
  WheelForces f;
  f.load = r * b * both([&](double t) { return tau_x(t) * std::sin(t) + sigma(t) * std::cos(t); });
  f.drawbar_pull = r * b * both([&](double t) { return tau_x(t) * std::cos(t) - sigma(t) * std::sin(t); });
  f.torque = r * r * b * both(tau_x);
  f.side = both([&](double t) { return r * b * tau_y(t) + bulldozed(t); });
  return f;
}

}  // namespace

TEST_CASE("the mobility index and the cone indices of HMMWVs are the published ones") {
  // M1152 of 13,450 lb, 17.4 in of clearance: MI 83.8, VCI1 27.8, VCI50 63.2; M998 of 7,700 lb: 19.4, 45.1.
  const double heavy = mobility_factors(hmmwv(13450, 17.4)).index();
  CHECK(agrees("M1152, mobility index", 83.8, heavy, 0.05));
  CHECK(agrees("M1152, VCI1 [psi]", 27.8, wheeled_cone_index(heavy, 0.15).one_pass, 0.05));
  CHECK(agrees("M1152, VCI50 [psi]", 63.2, wheeled_cone_index(heavy, 0.15).fifty_passes, 0.05));
  const double light = mobility_factors(hmmwv(7700, 16)).index();
  CHECK(agrees("M998, VCI1 [psi]", 19.4, wheeled_cone_index(light, 0.15).one_pass, 0.05));
  CHECK(agrees("M998, VCI50 [psi]", 45.1, wheeled_cone_index(light, 0.15).fifty_passes, 0.06));
  const VehicleIndex shipped = vehicle_index(shipped_vehicle("hmmwv"));
  CHECK(agrees("hmmwv.json, mobility index", 31.3, shipped.factors.index(), 0.05));
  CHECK(agrees("hmmwv.json, VCI1 [psi]", 16.6, shipped.cone_index.one_pass, 0.05));
  CHECK(agrees("hmmwv.json, VCI50 [psi]", 39.0, shipped.cone_index.fifty_passes, 0.05));
}

TEST_CASE("the M113's cone indices are the published 17 and 40 psi") {
  const VehicleIndex shipped = vehicle_index(shipped_vehicle("m113"));
  CHECK(agrees("VCI1 [psi]", 17, shipped.cone_index.one_pass, 0.5));
  CHECK(agrees("VCI50 [psi]", 40, shipped.cone_index.fifty_passes, 0.5));
}

TEST_CASE("factors of the mobility index switch where they should") {
  WheeledIndexInput in = hmmwv(5724, 16);
  CHECK(mobility_factors(in).engine == 1);
  in.power_per_mass = 9.9 * 745.7 / 907.18474;
  CHECK(mobility_factors(in).engine == 1.05);
  in.automatic = false;
  CHECK(mobility_factors(in).transmission == 1.05);
  // The weight factor rises nowhere by more than its steps of a few per cent, and the indices meet at MI 115.
  for (const double pounds : {2000.0, 13500.0, 20000.0}) {
    const double below = mobility_factors(hmmwv(2 * pounds - 1e-3, 16)).weight,
                 above = mobility_factors(hmmwv(2 * pounds + 1e-3, 16)).weight;
    CHECK(std::fabs(above - below) < 0.05 * below);
  }
  CHECK(agrees("VCI1 at MI 115, both formulas", wheeled_cone_index(115, 0.15).one_pass,
               wheeled_cone_index(115 + 1e-9, 0.15).one_pass, 0.5));
  CHECK(agrees("VCI50 at MI 115, both formulas", wheeled_cone_index(115, 0.15).fifty_passes,
               wheeled_cone_index(115 + 1e-9, 0.15).fifty_passes, 2.5));
  CHECK(agrees("softer tyres need less", std::pow(0.5, 0.25), deflection_correction(0.3), 1e-12));
  refused([] { vehicle_index(shipped_vehicle("mgru3")); }, "single-wheel");
  refused(
      [] {
        Vehicle v = shipped_vehicle("hmmwv");
        v.wheel[0].size_diameter = 0;
        vehicle_index(v);
      },
      "tyre_size");
}

TEST_CASE("Brixius: numbers worked by hand, and its limits") {
  // C_n 40, b/d 0.3, deflection/height 0.2: B_n = 40 * 2 / 1.9 = 42.105.
  const WheelOnSoil w{1e4, 1, 0.3, 0.25, 0.05, 40 * 1e4 / 0.3};
  CHECK(agrees("B_n", 80 / 1.9, brixius_number(w), 1e-12));
  const Traction t = brixius(w, 0.2, false);
  CHECK(agrees("gross, bias ply", 0.88 * (1 - 0.0148395) * (1 - 0.2231302) + 0.04, t.gross, 1e-6));
  CHECK(agrees("resistance, bias ply", 0.02375 + 0.04 + 0.1 / 6.4888568, t.resistance, 1e-6));
  CHECK(brixius(w, 0.2, true).gross > t.gross);
  WheelOnSoil soft = w;
  soft.cone_index /= 10;
  CHECK(brixius(soft, 0.2, false).net() < t.net());
  CHECK(agrees("no slip: only the constant is left", 0.04, brixius(w, 0, false).gross, 1e-12));
}

TEST_CASE("traction on sand and clay: limits, order, numbers worked by hand") {
  const double ratio = 0.5;
  CHECK(agrees("sand, far braked", -0.5, sand_net_traction(ratio, -8), 1e-6));
  CHECK(agrees("sand, spinning", 0.42 + 0.018, sand_net_traction(ratio, 8), 1e-6));
  for (double s = -1; s < 1; s += 0.05) CHECK(sand_net_traction(ratio, s + 0.05) > sand_net_traction(ratio, s));
  // Firmer sand carries more, down to the least ratio.
  for (double r = kMinPressureRatio; r < 2; r *= 1.1)
    CHECK(sand_net_traction(r, 0.2) > sand_net_traction(1.1 * r, 0.2));
  // 1 + 0.788 e^-1.4 = 1.194319; to the power 1/1.516 it is 1.124268.
  CHECK(agrees("sand, ratio 0.5, slip 0.2", -0.5 + 0.938 / std::pow(1.194319, 1 / 1.516), sand_net_traction(0.5, 0.2),
               1e-6));
  const WheelOnSoil w{1e4, 1, 0.3, 0.25, 0.0375, 40 * 1e4 / 0.3};
  CHECK(agrees("sand numeric", 40 * 1e4 / 0.3 / 3.47 / kInch * std::pow(0.3, 1.5) * 0.15 / 1e4, sand_numeric(w), 1e-9));
  CHECK(agrees("sand gross at numeric 20, slip 0.2", 0.66 - 0.66 * 13.31 / 43.31, sand_gross_traction(20, 0.2), 1e-12));
  const double n = clay_numeric(w);
  CHECK(agrees("clay numeric", 40 / (std::pow(0.85, 1.5) * std::pow(1.3, 0.75)), n, 1e-9));
  CHECK(agrees("clay, self-powered: no gross traction", 0, clay_traction(w, clay_self_powered_slip(n)).gross, 1e-12));
  WheelOnSoil soft = w;
  soft.cone_index /= 8;
  CHECK(clay_traction(soft, 0.2).net() < 0);
  CHECK(clay_traction(w, 0.2).net() > 0.2);
}

TEST_CASE("plates sink by Bekker's law and back") {
  const BekkerSoil soil = lete_sand();
  CHECK(agrees("pressure at 50 mm under 0.2 m [Pa]", (102e3 / 0.2 + 5301e3) * std::pow(0.05, 0.79),
               plate_pressure(soil, 0.2, 0.05), 1e-6));
  CHECK(agrees("sinkage back [m]", 0.05, plate_sinkage(soil, 0.2, plate_pressure(soil, 0.2, 0.05)), 1e-12));
}

TEST_CASE("a track's thrust goes to Mohr-Coulomb at large slip and grows in proportion at small slip") {
  const BekkerSoil soil = lete_sand();
  const double load = 5e4, width = 0.38, length = 2.7;
  const double max = width * length * soil.cohesion + load * std::tan(soil.friction_angle);
  CHECK(agrees("slip 1000 [N]", max, track_forces(soil, width, length, load, 1000).thrust, 1e-4 * max));
  CHECK(agrees("slip 1e-6 [N]", max * 0.5 * 1e-6 * length / soil.shear_modulus,
               track_forces(soil, width, length, load, 1e-6).thrust, 1e-4 * max * 1e-4));
  const TrackForces f = track_forces(soil, width, length, load, 0.2);
  CHECK(agrees("work of compaction per metre [N]", f.resistance, load / length * f.sinkage / (soil.n + 1),
               1e-6 * f.resistance));
}

TEST_CASE("a wheel without shear only resists, by the work of compaction") {
  BekkerSoil soil = lete_sand();
  soil.cohesion = 0;
  soil.friction_angle = 0;
  for (const double entry : {0.2, 0.5, 0.9}) {
    // dz = r sin(theta) d(theta): the resistance is exactly b k z^(n+1) / (n+1).
    const WheelForces f = wheel_forces(soil, 0.45, 0.25, 0.2, entry, {0, 0});
    const double expected = 0.25 * plate_pressure(soil, 0.25, f.sinkage) * f.sinkage / (soil.n + 1);
    CHECK(agrees("resistance, entry " + short_text(entry) + " [N]", expected, -f.drawbar_pull, 1e-4 * expected));
    CHECK(f.torque == 0);
  }
}

TEST_CASE("Wong and Reece's wheel carries its load, pulls more with slip, and its work is not less than its pull's") {
  const BekkerSoil soil = lete_sand();
  const double radius = 0.467, width = 0.3175, load = 6370;
  double before = -1e9;
  for (const double slip : {0.05, 0.1, 0.2, 0.4, 0.7}) {
    const WheelForces f = wheel_forces_under(soil, radius, width, slip, load);
    CHECK(agrees("load at slip " + short_text(slip) + " [N]", load, f.load, 1e-4 * load));
    CHECK(f.drawbar_pull > before);
    // Power in, T w, is at least the pull's, DP w r (1 - slip).
    CHECK(f.torque >= f.drawbar_pull * radius * (1 - slip));
    CHECK(f.drawbar_pull < load * std::tan(soil.friction_angle) + 1300 * 0.2);
    before = f.drawbar_pull;
  }
  // One point by a coarser rule of its own: the normal and shear stress at the largest, straight from the formulas.
  const WheelForces one = wheel_forces(soil, radius, width, 0.2, 0.5);
  CHECK(agrees("sinkage at entry 0.5 [m]", radius * (1 - std::cos(0.5)), one.sinkage, 1e-12));
  double sum = 0;
  const int parts = 200000;
  const double largest = (0.4 + 0.2 * 0.2) * 0.5, k = 102e3 / width + 5301e3;
  for (int i = 0; i < parts; ++i) {
    const double at = 0.5 * (i + 0.5) / parts, from = at > largest ? at : 0.5 - at * (0.5 - largest) / largest;
    const double p = k * std::pow(radius * (std::cos(from) - std::cos(0.5)), 0.79);
    const double j = radius * (0.5 - at - 0.8 * (std::sin(0.5) - std::sin(at)));
    sum +=
        0.5 / parts * radius * radius * width * (1300 + p * std::tan(soil.friction_angle)) * (1 - std::exp(-j / 0.012));
  }
  CHECK(agrees("torque by a plain sum [N m]", sum, one.torque, 1e-4 * sum));
  BekkerSoil mud = soil;
  mud.k_c = 0;
  mud.k_phi = 1e3;
  refused([&] { wheel_forces_under(mud, radius, width, 0.2, load); }, "sinks");
}

TEST_CASE("a wheel at a slip angle has Ishigami's forces, by an independent quadrature") {
  for (const double s_x : {-0.2, 0.1, 0.5, 0.9})
    for (const double degrees : {-30.0, 5.0, 45.0}) {
      const double beta = degrees * kDegree, front = 0.6;
      // Slip counts by the whole speed of travel here, and along the heading there.
      const WheelMotion motion{1 - (1 - s_x) / std::cos(beta), beta};
      const WheelForces ours = wheel_forces(simulant(), RigidWheel{0.09, 0.11}, motion, front);
      const WheelForces his = by_quadrature(simulant(), 0.09, 0.11, s_x, beta, front);
      const std::string at = ", slip " + short_text(s_x) + ", " + short_text(degrees) + " deg";
      CHECK(agrees("load" + at + " [N]", his.load, ours.load, 1e-4 * his.load));
      CHECK(agrees("pull" + at + " [N]", his.drawbar_pull, ours.drawbar_pull, 1e-4 * his.load));
      CHECK(agrees("side force" + at + " [N]", his.side, ours.side, 1e-4 * his.load));
      CHECK(agrees("torque" + at + " [N m]", his.torque, ours.torque, 1e-5 * his.load));
    }
}

TEST_CASE("side forces mirror with the slip angle, vanish without one and grow with it") {
  const RigidWheel wheel{0.09, 0.11};
  double before = 0;
  for (const double degrees : {5.0, 15.0, 30.0, 60.0, 90.0}) {
    const WheelForces left = wheel_forces_under(simulant(), wheel, {0.2, degrees * kDegree}, 65);
    const WheelForces right = wheel_forces_under(simulant(), wheel, {0.2, -degrees * kDegree}, 65);
    CHECK(left.side == -right.side);
    CHECK(left.drawbar_pull == right.drawbar_pull);
    CHECK(left.side > before);
    before = left.side;
  }
  CHECK(wheel_forces_under(simulant(), wheel, {0.2, 0}, 65).side == 0);
}

TEST_CASE("lugs: a wheel as large as their tips with Bekker's factors") {
  const RigidWheel lugged{0.157, 0.165, 0.010};
  BekkerSoil soil = lete_sand();
  const WheelForces f = wheel_forces(soil, lugged, {0.3, 0}, 0.5);
  // h / b = 0.0606; arccot(0.0606) = 1.51027: factors 1.12121 and 1.05858.
  soil.cohesion *= 1.12121;
  soil.friction_angle = std::atan(1.05858 * std::tan(soil.friction_angle));
  const WheelForces same = wheel_forces(soil, RigidWheel{0.167, 0.165}, {0.3, 0}, 0.5);
  CHECK(agrees("pull [N]", same.drawbar_pull, f.drawbar_pull, 1e-4 * same.load));
  CHECK(agrees("torque [N m]", same.torque, f.torque, 1e-4 * same.torque));
  CHECK(f.torque > wheel_forces(lete_sand(), RigidWheel{0.167, 0.165}, {0.3, 0}, 0.5).torque);
}
