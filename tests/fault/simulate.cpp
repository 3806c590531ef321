// One trial killed and interrupted at the command line: the same command goes on and prints what it would have printed.
#include <csignal>

#include "base/files/file.h"
#include "base/json/json.h"
#include "tests/fault/program.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"

namespace gonogo {
namespace fs = std::filesystem;
namespace {

/// The demo study with a short bed and a short drive.
fs::path short_study(const TemporaryFolder& folder) {
  const fs::path configs = fs::path(GONOGO_SOURCE_DIR) / "configs";
  Json study = Json::parse(read_file(configs / "studies/demo.json"), "demo.json");
  study["vehicle"] = (configs / "vehicles/hmmwv_quarter.json").string();
  study["soil"]["calibration"] = (configs / "soils/calibration_90mm.json").string();
  study["trial"]["bed"]["length_m"] = 1.8;
  study["trial"]["drive"]["time_limit_s"] = 1.0;
  write_file_atomically(folder / "study.json", study.dump());
  return folder / "study.json";
}

}  // namespace

TEST_CASE("a trial that was killed or interrupted goes on to the same result") {
  const TemporaryFolder folder;
  const fs::path study = short_study(folder), saved = folder / "trial.h5";
  const std::vector<std::string> words{"simulate", study, "--seed", "3", "--json", "--csv", folder / "run.csv"};
  const Ending through = run_gonogo(words);
  REQUIRE(through.exit_code == 0);
  const std::string csv = read_file(folder / "run.csv");
  std::vector<std::string> saving = words;
  for (const std::string& word :
       {std::string("--checkpoint"), saved.string(), std::string("--checkpoint-every"), std::string("0")})
    saving.push_back(word);
  for (const int signal : {SIGKILL, SIGINT, SIGTERM}) {
    fs::remove(folder / "run.csv");
    RunOptions options;
    options.signal = signal;
    options.when = [&] { return fs::exists(saved); };
    const Ending cut = run_gonogo(saving, options);
    if (signal == SIGKILL) {
      CHECK(cut.signal == SIGKILL);
      CHECK(cut.out == "");
    } else {
      CHECK(cut.exit_code == 130);
      CHECK(Json::parse(cut.out, "stdout").at("error").at("kind").string() == "interrupted");
    }
    REQUIRE(fs::exists(saved));
    const Ending continued = run_gonogo(saving);
    CHECK(continued.exit_code == 0);
    CHECK(continued.out == through.out);
    CHECK(read_file(folder / "run.csv") == csv);
    CHECK_FALSE(fs::exists(saved));
  }
}

TEST_CASE("a trial without a checkpoint ends at SIGINT and SIGTERM and says that it will begin anew") {
  const TemporaryFolder folder;
  const fs::path study = short_study(folder), vtk = folder / "vtk";
  for (const int signal : {SIGINT, SIGTERM}) {
    RunOptions options;
    options.signal = signal;
    options.when = [&] { return fs::exists(vtk); };
    const Ending cut = run_gonogo({"simulate", study, "--csv", folder / "run.csv", "--vtk", vtk}, options);
    CHECK(cut.exit_code == 130);
    CHECK(cut.out == "");
    CHECK(contains(cut.err, "gonogo: interrupted; the trial will begin anew"));
    CHECK_FALSE(fs::exists(folder / "run.csv"));
    fs::remove_all(vtk);
  }
}

TEST_CASE("a checkpoint that belongs to another trial is refused with what to do") {
  const TemporaryFolder folder;
  const fs::path study = short_study(folder), saved = folder / "trial.h5";
  RunOptions options;
  options.signal = SIGKILL;
  options.when = [&] { return fs::exists(saved); };
  const std::vector<std::string> words{"simulate", study, "--checkpoint", saved, "--checkpoint-every", "0"};
  REQUIRE(run_gonogo(words, options).signal == SIGKILL);
  std::vector<std::string> other = words;
  other.insert(other.end(), {"--set", "slope_along=3"});
  check_refusal(run_gonogo(other), 2, {"trial.h5", "another scene", "remove it"});
  std::vector<std::string> film = words;
  film.insert(film.end(), {"--vtk", folder / "vtk"});
  check_refusal(run_gonogo(film), 2, {"--checkpoint does not go with"});
}

TEST_CASE("a variable that the design leaves open is asked for before anything runs") {
  const TemporaryFolder folder;
  const fs::path path = short_study(folder);
  Json study = Json::parse(read_file(path), "study.json");
  study["design"] = Json::object();
  study["design"]["method"] = "csv";
  study["design"]["file"] = "points.csv";
  write_file_atomically(path, study.dump());
  check_refusal(run_gonogo({"simulate", path, "--set", "slope_along=3"}), 2,
                {"study.json", "slope_across", "between", "--set slope_across="});
}

}  // namespace gonogo
