// Top speed: against the driveline's own closed form on hard ground, and what soil and slope take from it.
#include "pipeline/map/evaluate/outcome_model.h"

#include <algorithm>
#include <cmath>

#include "base/json/json.h"
#include "base/math/random.h"
#include "base/units.h"
#include "pipeline/campaign/study/contract.h"
#include "tests/support/catch.h"
#include "vehicle/model/statics.h"

using namespace gonogo;
using namespace gonogo::campaign;
using namespace gonogo::map;

namespace {

const std::string kFile = GONOGO_SOURCE_DIR "/configs/vehicles/hmmwv.json";

std::size_t width() { return contract().variables.size(); }

/// Ground that takes this share of the weight and gives way by this much.
SpeedModel model_on(double resistance, double sinkage) {
  const vehicle::Vehicle v = vehicle::read_vehicle(kFile);
  SpeedModel model;
  model.drive = vehicle::TractiveForce(v);
  model.mass = vehicle::weigh(v).total;
  model.rut_width = 0.5;
  model.resistance = {.constant = resistance, .lowest = resistance, .highest = resistance, .fastest = 3, .trials = 1};
  const std::vector<double> point(width(), 0.0), zero{0.0}, sinks{sinkage};
  model.slip = fit_measure("slip", "", point, zero);
  model.sinkage = fit_measure("sinkage", "m", point, sinks);
  return model;
}

SoilSpeed speed_on(const SpeedModel& model) { return {model, {std::vector<double>(width(), 0.0)}}; }

/// Force in the best gear from the numbers of the file: torque of the engine's table over gear, axle and radius.
double force_by_file(const Json& file, double speed) {
  const Json& d = file.at("driveline");
  const auto &at = d.at("engine").at("speed_rad_s").items(), &torque = d.at("engine").at("torque_N_m").items();
  const double radius = file.at("wheels").at("tyre").at("radius_m").number();
  double best = 0;
  for (const Json& gear : d.at("gears_output_per_input").items()) {
    const double ratio = 1 / gear.number() / d.at("final_drive_output_per_input").number();
    const double engine = speed / radius * ratio;
    for (std::size_t i = 1; i < at.size(); ++i) {
      const double low = at[i - 1].number(), high = at[i].number();
      if (engine < low || engine > high) continue;
      const double share = (engine - low) / (high - low);
      best = std::max(best, (torque[i - 1].number() * (1 - share) + torque[i].number() * share) * ratio / radius);
    }
  }
  return best;
}

}  // namespace

TEST_CASE("on hard ground the top speed on the level and on a grade is the driveline's within 3 %") {
  const Json file = Json::read(kFile);
  const SoilSpeed hard = speed_on(model_on(0, 0));
  const double weight = vehicle::weigh(vehicle::read_vehicle(kFile)).total * kGravity;
  CHECK(hard.at({0, 0}) == Approx(246.0 * 1.5361 * 0.2 * 0.467).epsilon(0.03));  // torque vanishes at 246 rad/s
  for (const double slope : {3.0, 8.0, 17.0, 27.0, 35.0}) {
    INFO(slope);
    const double speed = hard.at({slope, 0}), needed = weight * std::sin(to_radians(slope));
    CHECK(force_by_file(file, 0.97 * speed) > needed);
    CHECK(force_by_file(file, 1.03 * speed) < needed);
  }
  CHECK(hard.at({-20, 0}) == hard.at({0, 0}));
}

TEST_CASE("motion resistance takes as much as a grade of the same tangent, and ruts slow down fast vehicles alone") {
  const double along = to_degrees(std::atan(0.2));
  const double by_grade = speed_on(model_on(0, 0)).at({along, 0});
  const double load = std::cos(to_radians(along));  // the grade takes part of the load across the ground
  CHECK(speed_on(model_on(0.2 * load, 0)).at({0, 0}) == Approx(by_grade).epsilon(1e-3));
  const double shallow = speed_on(model_on(0.1, 0.02)).at({0, 0}), deep = speed_on(model_on(0.1, 0.2)).at({0, 0});
  CHECK(deep < shallow);
  CHECK(shallow < speed_on(model_on(0.1, 0)).at({0, 0}));
  SpeedModel slow = model_on(0.1, 0.2);
  slow.resistance.fastest = 50;  // trials that were as fast: their resistance holds all of it
  CHECK(speed_on(slow).at({0, 0}) == Approx(speed_on(model_on(0.1, 0)).at({0, 0})));
}

TEST_CASE("the resistance of trials is found again from trials with scatter, and never left") {
  std::vector<ResistanceTrial> trials;
  for (std::uint64_t i = 0; i < 400; ++i) {
    ResistanceTrial t{
        .rut = 0.2 * random_unit(3, 0, i), .slip = random_unit(3, 1, i), .speed = 1 + 2 * random_unit(3, 2, i)};
    t.resistance = 0.03 + 2.5 * t.rut + 0.1 * t.slip + 0.01 * t.speed + 0.02 * (random_unit(3, 3, i) - 0.5);
    trials.push_back(t);
  }
  const ResistanceFit fit = fit_resistance(trials);
  CHECK(fit.constant == Approx(0.03).margin(0.005));
  CHECK(fit.per_rut == Approx(2.5).margin(0.05));
  CHECK(fit.per_slip == Approx(0.1).margin(0.01));
  CHECK(fit.per_speed == Approx(0.01).margin(0.003));
  CHECK(fit.error == Approx(0.02 / std::sqrt(12.0)).epsilon(0.1));
  CHECK(fit.at(1, 0, 1) == fit.highest);
  CHECK(fit.at(0.1, 0.1, 100) == fit.at(0.1, 0.1, fit.fastest));
}

TEST_CASE("speeds obey the limit that was asked for") {
  const SoilSpeed limited(model_on(0, 0), {std::vector<double>(width(), 0.0)}, 20);
  CHECK(limited.at({0, 0}) == 20);
  CHECK(limited.at({35, 0}) < 20);
}

TEST_CASE("a bound on the force that is needed leaves the balance where it is") {
  const vehicle::TractiveForce drive(vehicle::read_vehicle(kFile));
  const double top = drive.top_speed(), strongest = drive.at(0.01 * top);
  for (std::uint64_t k = 0; k < 200; ++k) {
    const double rest = strongest * random_unit(7, 0, k), steep = strongest * random_unit(7, 1, k);
    const double falls = 0.5 * rest * random_unit(7, 2, k);  // by the speed at which it is constant again
    const auto needed = [&](double v) {
      return rest - falls * std::min(1.0, 4 * v / top) + steep * std::max(0.0, v / top - 0.25);
    };
    const auto least = [&](double v) { return rest - falls + steep * std::max(0.0, v / top - 0.25); };
    const double balance = drive.balance(needed);
    CHECK(drive.balance(needed, least) == balance);
    if (balance > 0 && balance < top) CHECK(drive.at(balance) == Approx(needed(balance)).epsilon(1e-6));
  }
}
