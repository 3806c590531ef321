// Vehicle files that cannot be are refused by a sentence that names the place.
#include "tests/support/refused.h"
#include "tests/support/vehicles.h"

using namespace gonogo;
using namespace gonogo::test;

namespace {

struct Fault {
  const char *vehicle, *from, *to, *word;
};

const Fault kFaults[] = {
    Fault{"hmmwv", "\"mass_kg\": 2086.52", "\"mass_kg\": 0", "chassis.mass_kg"},
    Fault{"hmmwv", "\"mass_kg\": 2086.52", "\"mass_kg\": -5", "chassis.mass_kg"},
    Fault{"hmmwv", "\"mass_kg\": 5.813", "\"mass_kg\": 0", "suspensions.front.upper_arm.mass_kg"},
    Fault{"hmmwv", "\"mass_kg\": 14.705", "\"mass_kg\": 0", "wheels.tyre.parts[0].mass_kg"},
    Fault{"hmmwv", "[1078.52, 2955.66, 3570.2]", "[1078.52, 2955.66]", "needs 3 numbers"},
    Fault{"hmmwv", "[1078.52, 2955.66, 3570.2]", "[1078.52, 0, 3570.2]", "chassis.inertia_kg_m2[1]"},
    Fault{"hmmwv", "\"clearance_m\"", "\"products_kg_m2\": [0, 2500, 0], \"clearance_m\"", "not positive"},
    Fault{"hmmwv", "\"suspension\": \"rear\"", "\"suspension\": \"raer\"", "no suspension \"raer\""},
    Fault{"hmmwv", "\"wheel\": \"tyre\"", "\"wheel\": \"tire\"", "axles[0].wheel"},
    Fault{"hmmwv", "\"name\": \"rear\"", "\"name\": \"front\"", "two axles"},
    Fault{"hmmwv", "\"radius_m\": 0.467", "\"radius_m\": -0.467", "wheels.tyre.radius_m"},
    Fault{"hmmwv", "\"tie_rod\": { \"mass_kg\": 6.0, \"length_m\": 0.",
          "\"tie_rod\": { \"mass_kg\": 6.0, \"length_m\": 1.", "the loop does not close"},
    Fault{"hmmwv", "\"shortest_m\": 0.15", "\"shortest_m\": 0.28", "outside its stops"},
    Fault{"hmmwv", "\"longest_m\": 0.3", "\"longest_m\": 0.1", "stops.longest_m"},
    Fault{"hmmwv", "\"type\": \"double_wishbone\"", "\"type\": \"macpherson\"", "macpherson"},
    Fault{"hmmwv", "\"upper_ball\": [-0.05304, 0.71552, 0.21549]", "\"upper_ball\": [-0.04791, 0.44596, 0.24462]",
          "lies on the arm's axis"},
    Fault{"hmmwv", "\"wheel\": [-0.04039, 0.9097", "\"wheel\": [-0.04039, 0.1", "overlap"},
    Fault{"hmmwv", "\"upper_ball\"", "\"upper_bal\"", "points_m.upper_ball: missing"},
    Fault{"hmmwv", "\"steering\": { \"max_angle_deg\": 30 },", "", "max_angle_deg"},
    Fault{"hmmwv", "\"torque_bias\": 4", "\"torque_bias\": 0.5", "torque_bias"},
    Fault{"hmmwv", "\"gears_output_per_input\": [0.1708", "\"gears_output_per_input\": [-0.1708",
          "gears_output_per_input[0]"},
    Fault{"hmmwv", "\"speed_rad_s\": [-10.472, 83.776", "\"speed_rad_s\": [-10.472, -83.776", "speed_rad_s[1]"},
    Fault{"hmmwv", "\"driver\"", "\"pilot\"", "pilot"},
    Fault{"viper", "\"torque_N_m\": [300, 0]", "\"torque_N_m\": [300]", "values for the"},
    Fault{"m113", "\"left_count\": 63", "\"left_count\": 55", "the loop does not close"},
    Fault{"m113", "\"right_count\": 64", "\"right_count\": 70", "the loop does not close"},
    Fault{"m113", "\"suspension\": \"arm\"", "\"suspension\": \"leg\"", "no suspension \"leg\""},
    Fault{"m113", "\"damped\": [0, 1, 4]", "\"damped\": [0, 1, 5]", "damped[2]"},
    Fault{"viper", "\"driven\": true", "\"driven\": false", ""},
    Fault{"mgru3", "\"single\": true", "\"single\": false", "overlap"},
};

}  // namespace

TEST_CASE("vehicle files that cannot be are refused, and the message names the place") {
  for (const Fault& f : kFaults) {
    INFO(f.vehicle << ": " << f.from << " -> " << f.to);
    if (std::string(f.word).empty())
      CHECK_NOTHROW(changed_vehicle(f.vehicle, f.from, f.to));  // one driven axle is enough
    else
      refused([&] { changed_vehicle(f.vehicle, f.from, f.to); }, f.word);
  }
}

TEST_CASE("a vehicle that nothing drives is refused") {
  refused([] { changed_vehicle("mgru3", "\"driven\": true", "\"driven\": false"); }, "no axle is driven");
}

TEST_CASE("a quarter vehicle does not stand by itself, and a whole one is no quarter") {
  refused([] { vehicle::read_vehicle(vehicle_path("hmmwv_quarter")); }, "kind");
  refused([] { vehicle::read_quarter_vehicle(vehicle_path("hmmwv")); }, "kind");
}
