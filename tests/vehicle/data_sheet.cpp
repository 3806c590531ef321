// Vehicle files from data sheets: tyre sizes against published ones, the HMMWV against the shipped one, refusals.
#include "vehicle/family/data_sheet.h"

#include "tests/support/catch.h"
#include "tests/support/refused.h"
#include "tests/support/vehicles.h"
#include "vehicle/model/statics.h"
#include "vehicle/semi_empirical/mobility_index.h"

namespace gonogo::vehicle {
namespace {

DataSheet hmmwv_sheet() {
  DataSheet s;
  s.name = "hmmwv";
  s.mass = 2597.14;
  s.wheelbase = {3.302};
  s.track = 1.8194;
  s.tyre = read_tyre_size("37x12.50R16.5");
  s.power = 141700;
  s.top_speed = 31;
  s.clearance = 0.41;
  s.centre_height = 0.69;
  s.centre_behind = 1.601;
  s.lug_height = 0.003;  // hmmwv.json's tread radius is 3 mm below half of the nominal diameter
  s.sources = {"the shipped file"};
  return s;
}

DataSheet truck_sheet() {
  DataSheet s = hmmwv_sheet();
  s.name = "truck";
  s.mass = 16000;
  s.axles = 3;
  s.wheelbase = {4.1, 1.4};
  s.track = 2.05;
  s.tyre = read_tyre_size("395/85R20");
  s.power = 250e3;
  s.clearance = 0.5;
  s.centre_height = {};
  s.centre_behind = 2.8;
  return s;
}

DataSheet robot_sheet() {
  DataSheet s;
  s.name = "robot";
  s.mass = 50;
  s.wheelbase = {0.512};
  s.track = 0.57;
  s.tyre = read_tyre_size("0.33x0.114");
  s.power = 200;
  s.top_speed = 1;
  s.clearance = 0.13;
  s.sources = {"a data sheet"};
  return s;
}

Vehicle made(const DataSheet& s) { return read_vehicle(Config::parse(vehicle_file(s).json.dump(), s.name)); }

}  // namespace

TEST_CASE("tyre sizes have the diameters that their makers publish") {
  // Overall diameters of catalogues, in inches: 14.00R20, 16.00R20, 365/80R20 and 395/85R20 of Michelin's XZL.
  const std::pair<const char*, double> published[] = {
      {"37x12.50R16.5", 37}, {"37X12.50R16.5LT", 37}, {"25x8-12", 25},    {"LT285/70R17", 32.7}, {"395/85R20", 46.4},
      {"365/80R20", 43.0},   {"14.00R20", 49.4},      {"16.00R20", 52.9}, {"205/55R16", 24.9}};
  for (const auto& [text, inches] : published) {
    INFO(text);
    CHECK(read_tyre_size(text).diameter == Approx(inches * kInch).epsilon(0.01));
  }
  const TyreSize humvee = read_tyre_size("37x12.50R16.5");
  CHECK(humvee.section_width == Approx(0.3175));
  CHECK(humvee.section_height() == Approx(0.26035));
  const TyreSize wheel = read_tyre_size("0.5 x 0.2");
  CHECK((wheel.diameter == 0.5 && wheel.section_width == 0.2 && !wheel.pneumatic()));
}

TEST_CASE("load indices, load limits and stiffnesses are those of tyres whose makers publish them") {
  CHECK(load_of_index(91) == Approx(615).epsilon(0.01));
  CHECK(load_of_index(121) == Approx(1450).epsilon(0.015));
  CHECK(load_of_index(168) == Approx(5600).epsilon(0.015));
  // 205/55R16 91 at 250 kPa; Michelin's XZL 395/85R20 168 at 725 kPa.
  CHECK(load_limit(read_tyre_size("205/55R16"), 250e3) / kGravity == Approx(615).epsilon(0.1));
  CHECK(load_limit(read_tyre_size("395/85R20"), 725e3) / kGravity == Approx(5600).epsilon(0.1));
  // Passenger tyres have 200 to 250 N/mm.
  CHECK(radial_stiffness(read_tyre_size("205/55R16"), 220e3) == Approx(225e3).epsilon(0.1));
  CHECK(radial_stiffness(read_tyre_size("205/55R16"), 100e3) <
        0.6 * radial_stiffness(read_tyre_size("205/55R16"), 220e3));
}

TEST_CASE("the HMMWV's data sheet makes a vehicle close to the shipped one") {
  const Vehicle v = made(hmmwv_sheet()), shipped = test::shipped_vehicle("hmmwv");
  CHECK(weigh(v).total == Approx(weigh(shipped).total).epsilon(1e-4));
  CHECK(weigh(v).unsprung == Approx(weigh(shipped).unsprung).epsilon(0.15));
  const auto loads = static_loads(v), theirs = static_loads(shipped);
  REQUIRE(loads.size() == theirs.size());
  for (std::size_t i = 0; i < loads.size(); ++i) CHECK(loads[i] == Approx(theirs[i]).epsilon(0.01));
  const Wheel &wheel = v.wheel.front(), &other = shipped.wheel.front();
  CHECK(wheel.radius == Approx(other.radius).epsilon(1e-3));
  CHECK(wheel.width == Approx(other.width));
  CHECK(wheel.compliant.stiffness == Approx(other.compliant.stiffness).epsilon(0.01));
  CHECK(vehicle_index(v).cone_index.one_pass == Approx(vehicle_index(shipped).cone_index.one_pass).epsilon(0.02));
  const Vec3d &a = v.chassis.moments, &b = shipped.chassis.moments;
  CHECK(a.x == Approx(b.x).epsilon(0.15));
  CHECK(a.y == Approx(b.y).epsilon(0.15));
  CHECK(a.z == Approx(b.z).epsilon(0.15));
}

TEST_CASE("mass, centre of mass and driveline are those of the sheet, for two to four axles, sprung and rigid") {
  DataSheet eight = truck_sheet();
  eight.axles = 4;
  eight.wheelbase = {1.5, 2.5, 1.5};
  for (const DataSheet& s : {hmmwv_sheet(), truck_sheet(), eight, robot_sheet()}) {
    INFO(s.name << " with " << s.axles << " axles");
    const Vehicle v = made(s);
    const Weights w = weigh(v);
    CHECK(w.total == Approx(s.mass).epsilon(1e-4));
    CHECK(w.centre.y == Approx(0).margin(1e-9));
    double base = 0;
    for (const double gap : s.wheelbase) base += gap;
    CHECK(base / 2 - w.centre.x == Approx(s.centre_behind.value_or(base / 2)).margin(1e-3));
    CHECK(w.centre.z - w.ground == Approx(s.centre_height.value_or(s.track / 2.4)).margin(1e-3));
    CHECK(tractive_force(v, 0) == Approx(s.mass * kGravity).epsilon(1e-3));
    const double middle = 0.7 * s.top_speed, force = tractive_force(v, middle);
    CHECK(force * middle == Approx((s.mass < 100 ? 1 : 0.85) * s.power).epsilon(0.05));
    CHECK(tractive_force(v, 1.03 * s.top_speed) == 0);
    CHECK(stations(v).size() == std::size_t(2 * s.axles));
  }
}

TEST_CASE("every assumption is told, and what is given is not assumed") {
  const VehicleFile plain = vehicle_file(robot_sheet());
  DataSheet full = robot_sheet();
  full.centre_height = 0.2;
  full.lug_height = 0.01;
  const VehicleFile told = vehicle_file(full);
  const auto tells = [](const VehicleFile& f, const std::string& word) {
    return std::any_of(f.assumed.begin(), f.assumed.end(),
                       [&](const std::string& a) { return a.find(word) != std::string::npos; });
  };
  CHECK(tells(plain, "static stability factor"));
  CHECK_FALSE(tells(told, "static stability factor"));
  CHECK(tells(plain, "lugs: none"));
  CHECK(tells(told, "lugs: 24 around the wheel"));
  CHECK(plain.json.at("unsourced").items().size() == plain.assumed.size());
}

TEST_CASE("sheets that make no vehicle are refused in one sentence") {
  for (const char* size : {"37x", "banana", "", "395/85", "R20", "1e3x2", "9.00-20-3"})
    refused([&] { read_tyre_size(size); }, "cannot be read");
  refused([] { read_tyre_size("37x12.50R36"); }, "makes a section");
  refused([] { read_tyre_size("9x0.2"); }, "diameter");
  const auto refuse = [](const std::string& word, const auto& change) {
    DataSheet s = hmmwv_sheet();
    change(s);
    refused([&] { vehicle_file(s); }, word);
  };
  refuse("clearance: -0.1 m", [](DataSheet& s) { s.clearance = -0.1; });
  refuse("axles: 5 are given; the family has vehicles of 2 to 4", [](DataSheet& s) { s.axles = 5; });
  refuse("on a tyre, and 37x12.50R16.5 bears", [](DataSheet& s) { s.mass = 20000; });
  refuse("by its load index", [](DataSheet& s) { s.load_index = 80; });
  refuse("wheelbase: 2 distances are given for 2 axles", [](DataSheet& s) { s.wheelbase = {2, 2}; });
  refuse("m apart", [](DataSheet& s) { s.wheelbase = {0.5}; });
  refuse("overlap", [](DataSheet& s) { s.track = 0.2; });
  refuse("leaves no load on axle 1", [](DataSheet& s) { s.centre_behind = 9; });
  refuse("keep one of them", [](DataSheet& s) { s.inflation = 2e5, s.deflection = 0.03; });
  refuse("mass: 0 kg", [](DataSheet& s) { s.mass = 0; });
  refuse("gravity", [](DataSheet& s) { s.gravity = 300; });
  refuse("is a wheel without a tyre", [](DataSheet& s) { s.tyre = read_tyre_size("0.9x0.3"), s.inflation = 2e5; });
}

}  // namespace gonogo::vehicle
