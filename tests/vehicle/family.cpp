// Numbers without dimension: canonical wheels have the numbers they were made from, at every size and gravity.
#include <array>
#include <sstream>

#include "base/files/csv.h"
#include "base/files/file.h"
#include "base/units.h"
#include "tests/support/catch.h"
#include "tests/support/refused.h"
#include "tests/support/vehicles.h"
#include "vehicle/family/common_pull.h"
#include "vehicle/family/vehicle_numbers.h"
#include "vehicle/model/statics.h"

namespace gonogo::vehicle {
namespace {

Family shipped_family() { return read_family(Config::read(GONOGO_SOURCE_DIR "/configs/families/wheeled.json")); }

constexpr WheelNumbers kLugged{.load = 1.7, .width = 0.3, .deflection = 0.04, .lug = 0.03};

}  // namespace

TEST_CASE("a canonical wheel has the numbers it was made from, at every size and gravity") {
  for (const double diameter : {0.25, 1.0, 2.0})
    for (const double gravity : {kGravity, kGravity / 3, kGravity / 6}) {
      Family family = shipped_family();
      family.diameter = diameter;
      const Vehicle v = canonical_wheel(family, kLugged, gravity);
      const double load = weigh(v).total * gravity;
      const WheelNumbers n = wheel_numbers(v.wheel.front(), load, gravity);
      CHECK(n.load == Approx(kLugged.load));
      CHECK(n.width == Approx(kLugged.width));
      CHECK(n.deflection == Approx(kLugged.deflection));
      CHECK(n.lug == Approx(kLugged.lug));
      CHECK(load == Approx(load_of(family, kLugged, gravity)));
      // Slonaker's group rho D L^2 / M, with the width D and the radius L.
      const Wheel& w = v.wheel.front();
      CHECK(kFamilyDensity * w.width * w.radius * w.radius / weigh(v).total == Approx(1 / (4 * kLugged.load)));
    }
}

TEST_CASE("the family at half a metre has the ranges of that at one metre") {
  const auto without_size = [](const std::string& name) {
    std::istringstream file(read_file(GONOGO_SOURCE_DIR "/configs/families/" + name + ".json"));
    std::string kept;
    for (std::string line; std::getline(file, line);)
      if (line.find("\"about\"") == line.npos && line.find("\"diameter_m\"") == line.npos) kept += line + '\n';
    return kept;
  };
  CHECK(without_size("wheeled_half_metre") == without_size("wheeled"));
  CHECK(read_family(Config::read(GONOGO_SOURCE_DIR "/configs/families/wheeled_half_metre.json")).diameter == 0.5);
}

TEST_CASE("axles carry the weight, and its moment about the first axle, on level ground and on slopes") {
  for (const int axles : {2, 3, 4})
    for (const double slope : {0.0, 0.2}) {
      VehicleNumbers v;
      v.axles = axles;
      v.axle_gap = 1.5;
      v.centre_height = 0.9;
      v.centre_behind = 0.45;
      const double base = v.axle_gap + axles - 1;
      double sum = 0, moment = 0;
      const std::vector<double> shares = axle_shares(v, slope);
      for (int i = 0; i < axles; ++i) {
        sum += shares[std::size_t(i)];
        moment += shares[std::size_t(i)] * base * i / (axles - 1);
      }
      CHECK(sum == Approx(1));
      CHECK(moment == Approx(0.45 * base + 0.9 * std::tan(slope)));
    }
}

TEST_CASE("scaled wheels swing and turn alike in units of sqrt(D / g)") {
  const Family one = shipped_family();
  Family small = one;
  small.diameter = one.diameter / 4;
  const double gravity = kGravity / 6, time = std::sqrt(small.diameter / gravity) / std::sqrt(one.diameter / kGravity);
  const Vehicle a = canonical_wheel(one, kLugged, kGravity), b = canonical_wheel(small, kLugged, gravity);
  const double mass = weigh(b).total / weigh(a).total;
  CHECK(mass == Approx(1.0 / 64));
  const auto alike = [&](const LinearSpring& x, const LinearSpring& y) {
    CHECK(y.stiffness == Approx(x.stiffness * mass / (time * time)));
    CHECK(y.damping == Approx(x.damping * mass / time));
  };
  alike(a.suspension.front().upright_spring, b.suspension.front().upright_spring);
  alike(a.wheel.front().compliant, b.wheel.front().compliant);
  CHECK(b.wheel.front().part.moments.y == Approx(a.wheel.front().part.moments.y * mass / 16));
  CHECK(largest_drive_torque(b) == Approx(largest_drive_torque(a) * mass / 4 / 6));
}

TEST_CASE("hardly compliant tyres are rigid, and hardly lugged wheels smooth") {
  const Vehicle v =
      canonical_wheel(shipped_family(), {.load = 1, .width = 0.2, .deflection = 0.004, .lug = 0.004}, kGravity);
  CHECK(v.wheel.front().compliant.stiffness == 0);
  CHECK(v.wheel.front().lug_count == 0);
}

TEST_CASE("the numbers of the HMMWV's wheel are those of its file") {
  const Vehicle v = read_quarter_vehicle(GONOGO_SOURCE_DIR "/configs/vehicles/hmmwv_quarter.json");
  const double load = weigh(v).total * kGravity;
  const WheelNumbers n = wheel_numbers(v.wheel.front(), load, kGravity);
  CHECK(n.load == Approx(643.2 / (1600 * 0.254 * 0.934 * 0.934)));
  CHECK(n.width == Approx(0.254 / 0.934));
  CHECK(n.deflection == Approx(643.2 * 9.81 / 163000 / 0.934));
  CHECK(n.lug == Approx(0.02 / 0.934));
}

namespace {

constexpr VehicleNumbers kTruck{.wheel = kLugged,
                                .axles = 3,
                                .axle_gap = 1.6,
                                .track = 2,
                                .centre_height = 0.8,
                                .centre_behind = 0.55,
                                .clearance = 0.4,
                                .force = 0.9,
                                .power = 1.1,
                                .top_speed = 2.5};

}  // namespace

TEST_CASE("a canonical vehicle has the numbers it was made from, at every size and gravity") {
  for (const double diameter : {0.25, 1.0, 2.0})
    for (const double gravity : {kGravity, kGravity / 3, kGravity / 6}) {
      INFO("diameter " << diameter << " m, gravity " << gravity << " m/s^2");
      Family family = shipped_family();
      family.diameter = diameter;
      const VehicleNumbers n = vehicle_numbers(canonical_vehicle(family, kTruck, gravity), gravity);
      const auto same = [](double x, double y) { CHECK(x == Approx(y).epsilon(1e-3)); };
      same(n.wheel.load, kTruck.wheel.load);
      same(n.wheel.width, kTruck.wheel.width);
      same(n.wheel.deflection, kTruck.wheel.deflection);
      same(n.wheel.lug, kTruck.wheel.lug);
      CHECK(n.axles == kTruck.axles);
      same(n.axle_gap, kTruck.axle_gap);
      same(n.track, kTruck.track);
      same(n.centre_height, kTruck.centre_height);
      same(n.centre_behind, kTruck.centre_behind);
      same(n.clearance, kTruck.clearance);
      same(n.force, kTruck.force);
      CHECK(n.power == Approx(kTruck.power).epsilon(0.02));
      CHECK(n.top_speed == Approx(kTruck.top_speed).epsilon(0.03));
    }
}

TEST_CASE("nine in ten of the table's vehicles lie inside the family in every number") {
  const Family family = shipped_family();
  const auto lines = read_csv_lines(GONOGO_SOURCE_DIR "/data/wheeled_vehicles/vehicles.csv", "vehicles");
  const auto column = [&](const char* name) {
    const auto& header = lines.front().cell;
    return std::size_t(std::find(header.begin(), header.end(), name) - header.begin());
  };
  int inside = 0, all = 0;
  for (std::size_t row = 1; row < lines.size(); ++row) {
    const auto value = [&](const char* name) { return std::stod(lines[row].cell.at(column(name))); };
    const double d = value("diameter_m"), weight = value("mass_kg") * value("gravity_m_s2"), axles = value("axles"),
                 speed = std::sqrt(value("gravity_m_s2") * d);
    Wheel wheel;
    wheel.radius = d / 2;
    wheel.width = value("width_m");
    wheel.lug_count = 1;
    wheel.lug_height = value("lug_m");
    const double load = weight / (2 * axles);
    if (value("deflection_m") > 0) wheel.compliant.stiffness = load / value("deflection_m");
    const VehicleNumbers n{.wheel = wheel_numbers(wheel, load, value("gravity_m_s2")),
                           .axles = int(axles),
                           .axle_gap = value("wheelbase_m") / d - (axles - 1),
                           .track = value("track_m") / d,
                           .centre_height = value("centre_height_m") / d,
                           .centre_behind = 0.5,
                           .clearance = value("clearance_m") / d,
                           .force = 1,
                           .power = value("power_W") / (weight * speed),
                           .top_speed = value("top_speed_m_s") / speed};
    bool in = true;
    for (const PlacedNumber& p : placed(family, n)) {
      if (!p.range.contains(p.value)) UNSCOPED_INFO(lines[row].cell[0] << ": " << p.name << " " << p.value);
      in = in && p.range.contains(p.value);
    }
    inside += in;
    ++all;
  }
  CHECK(all >= 25);
  CHECK(inside >= 0.9 * all);
  CHECK(inside < all);  // and the ranges are no wider than that
}

TEST_CASE("tracked vehicles and wheels by themselves are no members of the family") {
  refused([] { vehicle_numbers(test::shipped_vehicle("m113"), kGravity); }, "one on tracks");
  refused([] { vehicle_numbers(test::shipped_vehicle("mgru3"), kGravity); }, "a wheel by itself");
}

TEST_CASE("a family's file is refused for what is out of range") {
  const std::string text = R"({"vehicle": "f", "kind": "family", "about": "a", "sources": ["s"], "diameter_m": 9,
                               "friction": 0.8, "wheel_mass_share": 0.2, "spring_Hz": 2,
                               "lugs": {"count": 24, "thickness_ratio": 0.02}})";
  refused([&] { read_family(Config::parse(text, "f.json")); }, "diameter_m");
}

TEST_CASE("wheels that turn alike pull most in the way whose side force holds the vehicle") {
  const std::vector<double> shares = {0.25, 0.75};
  const std::array<AxleForces, 3> way = {AxleForces{0.5, 0.1}, AxleForces{0.4, 0.3}, AxleForces{0.1, 0.35}};
  const auto forces = [&](std::size_t axle, std::size_t k) {
    return AxleForces{way[k].pull * (axle == 0 ? 2.0 : 1.0), way[k].side};
  };
  const double doubled = 0.25 * 2 + 0.75;  // the front wheels pull twice as much of their load
  CHECK(largest_pull(shares, 3, 0, forces).pull == Approx(0.5 * doubled));
  CHECK(largest_pull(shares, 3, 0.2, forces).way == 1);
  CHECK(largest_pull(shares, 3, 0.2, forces).pull == Approx(0.4 * doubled));
  CHECK(largest_pull(shares, 3, 0.32, forces).way == 2);
  CHECK(largest_pull(shares, 3, 2, forces).way == 2);
}

TEST_CASE("wheels of an axle that lifts off are asked at a small load") {
  CHECK(axle_loads(std::vector<double>{0.5, 0.3, 0.2})[0] == Approx(1.5));
  CHECK(axle_loads(std::vector<double>{1.0, 0.0})[1] == Approx(0.02));
}

}  // namespace gonogo::vehicle
