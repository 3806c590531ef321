// gonogo vehicle: answers for shipped vehicles, and refusals.
#include <cmath>

#include "base/file.h"
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
