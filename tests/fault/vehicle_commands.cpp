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
  CHECK(answer({"feasible", "fed_alpha", "--slope", "25", "--mu", "2"}).at("moves").at("cause").string() == "torque");
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

namespace {

/// gonogo vehicle new for a buggy, with one option replaced or added.
std::vector<std::string> new_buggy(const std::string& out, const std::string& option = "",
                                   const std::string& value = "") {
  std::vector<std::string> words{"vehicle", "new", "buggy", "--out", out};
  std::vector<std::pair<std::string, std::string>> sheet{
      {"--mass", "700"},     {"--axles", "2"},  {"--wheelbase", "2.1"}, {"--track", "1.3"},
      {"--tyre", "26x9-12"}, {"--power", "50"}, {"--top-speed", "95"},  {"--clearance", "0.3"}};
  bool found = option.empty();
  for (auto& [name, given] : sheet) {
    if (name == option) given = value;
    found = found || name == option;
  }
  if (!found) sheet.emplace_back(option, value);
  for (const auto& [name, given] : sheet) words.push_back(name + "=" + given);
  return words;
}

}  // namespace

TEST_CASE("vehicle new writes a file that the other commands take, and keeps files that exist") {
  const TemporaryFolder folder;
  const std::string file = folder / "buggy.json";
  const Ending made = run_gonogo(new_buggy(file));
  REQUIRE(made.exit_code == 0);
  CHECK(contains(made.out, "static stability factor"));
  CHECK(contains(made.out, "gonogo vehicle show " + file));
  const Json shown = answer({"show", file});
  CHECK(shown.at("total_mass_kg").number() == Approx(700).epsilon(1e-4));
  CHECK(shown.at("wheels").items().size() == 4);
  CHECK(answer({"vci", file}).at("vci1_psi").number() > 5);
  CHECK(answer({"numbers", file}).at("inside").boolean());
  const Json strong = answer({"numbers", "mgru3_rover"});  // more force than sampled, and a lower centre of mass
  CHECK(strong.at("inside").boolean());
  for (const Json& number : strong.at("numbers").items()) {
    INFO(number.at("name").string());
    const bool ends =
        number.at("name").string() == "force_number" || number.at("name").string() == "centre_height_ratio";
    CHECK((number.at("counts_as").number() != number.at("value").number()) == ends);
  }
  CHECK(contains(run_gonogo({"vehicle", "numbers", "mgru3_rover"}).out, "54 % above, counts as 4"));
  check_refusal(run_gonogo(new_buggy(file)), 2, {"buggy.json", "exists already", "--out"});

  const std::string study = folder / "study.json";
  const Json written = answer({"study", file, "--points", "40", "--out", study});
  CHECK(written.at("trials").integer() == 40);
  CHECK(written.at("seconds").number() > 0);
  CHECK(run_gonogo({"design", study}).exit_code == 0);
#ifdef GONOGO_WITH_GDAL
  check_refusal(run_gonogo({"map", "--vehicle", "m113", "--dem", "any.tif", "--out", folder / "map"}), 2,
                {"the vehicle m113 has no model yet", "models ship for: ", "gonogo vehicle study", "600 trials"});
  check_refusal(run_gonogo({"map", "--dem", "any.tif", "--out", folder / "map"}), 2, {"--model is missing", "hmmwv"});
#endif
}

TEST_CASE("vehicle model writes what the family says of a vehicle, which other commands ask, sample and anneal") {
  const TemporaryFolder folder;
  const std::string file = folder / "buggy.json", model = folder / "buggy.h5", rows = folder / "rows.csv";
  REQUIRE(run_gonogo(new_buggy(file)).exit_code == 0);
  CHECK(answer({"model", file, "--out", model}).at("vehicle").string() == "buggy");
  const auto p_go = [&](const char* slope) {
    const Ending asked =
        run_gonogo({"infer", "--model", model, "--set", std::string("slope_along=") + slope, "--json"});
    REQUIRE(asked.exit_code == 0);
    return Json::parse(asked.out, "stdout").at("p_go").number();
  };
  CHECK(p_go("-10") > 0.9);
  CHECK(p_go("30") < 0.3);
  CHECK(run_gonogo({"sample", "--model", model, "--rows", "50", "--out", rows}).exit_code == 0);
  CHECK(contains(read_file(rows), "slope_along"));
  CHECK(run_gonogo({"qubo", "export", "--model", model, "--out", folder / "problem.json"}).exit_code == 0);

  check_refusal(run_gonogo({"vehicle", "model", "m113", "--out", folder / "m113.h5"}), 2, {"this is one on tracks"});
  check_refusal(run_gonogo({"vehicle", "model", file, "--family-model", "hmmwv", "--out", folder / "no.h5"}), 2,
                {"is no model of a family of vehicles; give one that is"});
  Json heavy = Json::read(file);
  heavy["chassis"]["mass_kg"] = 9000.0;
  write_file_atomically(folder / "heavy.json", heavy.dump());
  check_refusal(run_gonogo({"vehicle", "model", folder / "heavy.json", "--out", folder / "no.h5"}), 2,
                {"lies outside the family", "load_number", "gonogo vehicle study"});
  CHECK_FALSE(std::filesystem::exists(folder / "no.h5"));
}

TEST_CASE("vehicle new refuses sheets that make no vehicle, and writes nothing") {
  const TemporaryFolder folder;
  const std::string file = folder / "buggy.json";
  const auto refuse = [&](const std::string& option, const std::string& value, const std::vector<std::string>& words) {
    check_refusal(run_gonogo(new_buggy(file, option, value)), 2, words);
    CHECK_FALSE(std::filesystem::exists(file));
  };
  refuse("--tyre", "banana", {"tyre size \"banana\"", "37x12.50R16.5"});
  refuse("--axles", "5", {"axles: 5", "2 to 4"});
  refuse("--clearance", "-0.1", {"clearance", "-0.1"});
  refuse("--mass", "70000", {"kN on a tyre", "26x9-12 bears"});
  refuse("--mass", "7oo", {"--mass \"7oo\"", "is no number"});
  refuse("--load-index", "20", {"by its load index"});
  refuse("--drive", "sails", {"--drive \"sails\"", "engine, motors"});
  check_refusal(run_gonogo({"vehicle", "new", "buggy", "--mass", "700", "--out", file}), 2,
                {"missing: --axles, --wheelbase, --track, --tyre, --power, --top-speed, --clearance"});
  check_refusal(run_gonogo({"vehicle", "numbers", "m113"}), 2, {"m113", "one on tracks"});
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
