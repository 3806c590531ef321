// gonogo vehicle: answers for shipped vehicles, and refusals.
#include <cmath>

#include "base/files/file.h"
#include "tests/fault/program.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"

namespace gonogo {
namespace {

const std::string kVehicles = std::string(GONOGO_SOURCE_DIR) + "/configs/vehicles/";

Json answer(const std::vector<std::string>& words) {
  std::vector<std::string> all{"--json", "vehicle"};
  all.insert(all.end(), words.begin(), words.end());
  const Ending ending = run_gonogo(all);
  CHECK(ending.exit_code == 0);
  return Json::parse(ending.out, "stdout");
}

TEST_CASE("vehicle show, feasible and vci answer for a vehicle by name and by file") {
  // The program finds configs/vehicles of the tree that it was built in.
  CHECK(answer({"show", "hmmwv"}).dump() == answer({"show", kVehicles + "hmmwv.json"}).dump());
  CHECK(std::abs(answer({"show", "hmmwv"}).at("total_mass_kg").number() - 2597.1) < 0.1);
  CHECK(std::abs(answer({"vci", "hmmwv"}).at("vci50_psi").number() - 39.0) < 0.1);
  const Json gentle = answer({"feasible", "hmmwv", "--slope", "20", "--mu", "0.6"});
  CHECK(gentle.at("holds").at("feasible").boolean());
  CHECK(gentle.at("moves").at("feasible").boolean());
  const Json steep = answer({"feasible", "hmmwv", "--slope", "35", "--cross-slope", "-5", "--mu", "0.6"});
  CHECK(!steep.at("moves").at("feasible").boolean());
  CHECK(steep.at("moves").at("cause").string() == "traction");
  CHECK(answer({"feasible", "viper", "--step", "0.1", "--mu", "0.9"}).at("moves").at("feasible").boolean());
  CHECK(answer({"feasible", "m113", "--slope", "25"}).at("moves").at("cause").string() == "torque");
}

TEST_CASE("vehicle feasible --forces fits measured wheel forces and refuses files that say too little") {
  const TemporaryFolder folder;
  const std::string file = folder / "forces.json";
  const auto refusal = [&](const std::string& text, const std::vector<std::string>& words) {
    write_file_atomically(file, text);
    check_refusal(run_gonogo({"vehicle", "feasible", "hmmwv", "--forces", file}), 2, words);
  };
  write_file_atomically(file, R"({"wheels": {"front left": {"normal": {"force_N": 6700, "deviation_N": 50},
    "along": {"force_N": 900, "deviation_N": 40}}, "rear right": {"normal": {"force_N": 7300, "deviation_N": 50}}}})");
  const Json fit = answer({"feasible", "hmmwv", "--slope", "10", "--forces", file});
  CHECK(fit.at("measured").integer() == 3);
  const Json& holds = fit.at("holds");
  CHECK(holds.at("admissible").boolean());
  // Of the normal forces balance leaves one combination open, and two are measured.
  CHECK(holds.at("degrees_of_freedom").integer() == 1);
  CHECK(holds.at("chi_square").number() > 1);
  CHECK(holds.at("chi_square").number() < 3);
  CHECK(holds.at("forces").items().size() == 12);
  double along = 0;
  for (const Json& row : holds.at("forces").items()) {
    CHECK(row.at("low_N").number() <= row.at("force_N").number());
    CHECK(row.at("high_N").number() >= row.at("force_N").number());
    if (row.at("component").string() == "along") along += row.at("force_N").number();
  }
  CHECK(std::abs(along - 2597.1 * 9.80665 * std::sin(std::atan(1.) / 4.5)) < 5);  // the weight along 10 degrees
  const Json steep = answer({"feasible", "hmmwv", "--slope", "40", "--mu", "0.6", "--forces", file});
  CHECK(!steep.at("holds").at("admissible").boolean());
  CHECK(steep.at("holds").at("cause").string() == "traction");
  CHECK(contains(run_gonogo({"vehicle", "feasible", "hmmwv", "--forces", file}).out, "undetermined"));

  check_refusal(run_gonogo({"vehicle", "feasible", "hmmwv", "--step", "0.1", "--forces", file}), 2, {"plane", "step"});
  check_refusal(run_gonogo({"vehicle", "feasible", "m113", "--forces", file}), 2,
                {"front left", "m113", "no such wheel"});
  refusal(R"({"wheels": {"middle": {"normal": {"force_N": 1, "deviation_N": 1}}}})", {"middle", "front left"});
  refusal(R"({"wheels": {"front left": {"normal": {"force_N": 1, "deviation_N": -50}}}})", {"deviation_N", "-50"});
  refusal(R"({"wheels": {"front left": {"normal": {"force_N": 1}}}})", {"normal.deviation_N", "missing"});
  refusal(R"({"wheels": {"front left": {"normal": {"force": 1, "deviation_N": 50}}}})", {"force_N", "missing"});
  refusal(R"({"wheels": {"front left": {"normal": 6000}}})", {"normal", "expected an object"});
  refusal(R"({"wheels": {"front left": {"vertical": {"force_N": 1, "deviation_N": 50}}}})", {"vertical", "normal"});
  refusal(R"({"wheels": {"front left": {}}})", {"no force is measured"});
  refusal(R"({"wheels": {}})", {"no force is measured"});
  check_refusal(run_gonogo({"vehicle", "feasible", "hmmwv", "--forces", "/none/f.json"}), 2, {"/none/f.json"});
}

TEST_CASE("vehicles that are not there and questions that cannot be are refused") {
  check_refusal(run_gonogo({"vehicle", "show", "humvee"}), 2, {"humvee", "no such vehicle file", "hmmwv", "m113"});
  check_refusal(run_gonogo({"vehicle", "show", "/none/a.json"}), 2, {"/none/a.json", "no such vehicle file"});
  check_refusal(run_gonogo({"vehicle", "show", kVehicles + "hmmwv_quarter.json"}), 2, {"kind", "quarter", "wheeled"});
  check_refusal(run_gonogo({"vehicle", "feasible", "hmmwv", "--slope", "95"}), 2, {"95", "-80 to 80"});
  check_refusal(run_gonogo({"vehicle", "feasible", "hmmwv", "--mu", "0"}), 2, {"friction", "0.001 to 100"});
  check_refusal(run_gonogo({"vehicle", "feasible", "hmmwv", "--step", "-0.1"}), 2, {"step", "at least 0"});
  check_refusal(run_gonogo({"vehicle", "feasible", "m113", "--step", "0.2"}), 2, {"m113", "two axles"});
  check_refusal(run_gonogo({"vehicle", "vci", "mgru3"}), 2, {"mgru3", "single-wheel"});
  const TemporaryFolder folder;
  write_file_atomically(folder / "cut.json", read_file(kVehicles + "m113.json").substr(0, 900));
  check_refusal(run_gonogo({"vehicle", "show", folder / "cut.json"}), 2, {"cut.json"});
}

}  // namespace
}  // namespace gonogo
