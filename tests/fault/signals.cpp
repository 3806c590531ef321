// Ctrl-C and SIGTERM at thirty moments of each long command, and a limit on the size of files.
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>

#include "base/files/file.h"
#include "tests/fault/program.h"
#include "tests/fault/study_folder.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"
#include "tests/terrain/raster_maker.h"

namespace gonogo {
namespace fs = std::filesystem;
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kUntilHandlers = 0.5;  // that a loaded machine may take to start the program [s]

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

constexpr double kUntilStopped = 5;  // from the signal to the end on a loaded machine [s]

/// Runs a command with a signal at each of thirty moments of its length; `fresh` makes its words in a new folder. It
/// must end as the promise says, 130 or 0, soon, and never by the signal once its handler stands. At least `stopped_at`
/// of the moments must stop it.
template <class Fresh>
void interrupt(const Fresh& fresh, int stopped_at = 16) {
  constexpr int moments = 30;
  const auto start = Clock::now();
  REQUIRE(run_gonogo(fresh(0)).exit_code == 0);
  const double whole = seconds_since(start);
  int stopped = 0;
  for (int k = 0; k < moments; ++k) {
    const std::vector<std::string> words = fresh(k + 1);
    RunOptions options;
    options.signal = k % 2 == 0 ? SIGINT : SIGTERM;
    const auto begun = Clock::now();
    const double moment = whole * (k + 1) / (moments + 1);
    options.when = [&] { return seconds_since(begun) >= moment; };
    const Ending ending = run_gonogo(words, options);
    CHECK(seconds_since(begun) < moment + kUntilStopped);
    INFO("moment " << moment << " s of " << whole << " s\n" << ending.err);
    if (ending.signal == options.signal && moment < kUntilHandlers) continue;
    REQUIRE(ending.signal == 0);
    REQUIRE((ending.exit_code == 130 || ending.exit_code == 0));
    if (ending.exit_code != 130) continue;
    CHECK(contains(ending.err, "gonogo: interrupted"));
    ++stopped;
  }
  CHECK(stopped >= stopped_at);
}

/// The same for a command of minutes, at thirty moments of its first seconds: all of them must stop it.
template <class Fresh>
void interrupt_early(const Fresh& fresh, double first, double last) {
  constexpr int moments = 30;
  for (int k = 0; k < moments; ++k) {
    const std::vector<std::string> words = fresh(k);
    RunOptions options;
    options.signal = k % 2 == 0 ? SIGINT : SIGTERM;
    const auto begun = Clock::now();
    const double moment = first + (last - first) * k / (moments - 1);
    options.when = [&] { return seconds_since(begun) >= moment; };
    const Ending ending = run_gonogo(words, options);
    INFO("moment " << moment << " s\n" << ending.err);
    CHECK(seconds_since(begun) < moment + kUntilStopped);
    REQUIRE(ending.exit_code == 130);
    CHECK(contains(ending.err, "gonogo: interrupted"));
  }
}

const fs::path kSource = GONOGO_SOURCE_DIR;

std::vector<std::string> ground_words(const StudyFolder& study) {
  return {"--model", "hmmwv",     "--dem", study.path("elevation.asc"), "--soil", "loam", "--moisture",
          "moist",   "--threads", "2"};
}

}  // namespace

TEST_CASE("a map ends at once wherever it is interrupted and leaves no half map") {
  StudyFolder study;
  study.write();
  const TemporaryFolder folder;
  interrupt([&](int k) {
    if (k > 1)
      CHECK(fs::exists(folder / std::to_string(k - 1) / "map.json") ==
            fs::exists(folder / std::to_string(k - 1) / "index.html"));
    std::vector<std::string> words = ground_words(study);
    words.insert(words.begin(), "map");
    words.insert(words.end(), {"--out", folder / std::to_string(k)});
    return words;
  });
}

TEST_CASE("a run of trials and training and a map ends wherever it is interrupted and goes on") {
  std::vector<std::unique_ptr<StudyFolder>> studies;
  interrupt([&](int) {
    studies.push_back(std::make_unique<StudyFolder>());
    studies.back()->write();
    return studies.back()->run_words();
  });
  for (const int k : {5, 15, 25}) CHECK(run_gonogo(studies[std::size_t(k)]->run_words()).exit_code == 0);
}

TEST_CASE("a route ends at once wherever it is interrupted and leaves no half file") {
  StudyFolder study;
  study.write();
  const TemporaryFolder folder;
  interrupt(
      [&](int k) {
        return std::vector<std::string>{"route",
                                        "--model",
                                        "hmmwv",
                                        "--dem",
                                        study.path("elevation.asc"),
                                        "--soil",
                                        "sand, dry",
                                        "--from",
                                        "730020,4368020",
                                        "--to",
                                        "730200,4368060",
                                        "--out",
                                        folder / (std::to_string(k) + ".gpkg")};
      },
      5);
  check_nothing_half_written(folder.path());
}

TEST_CASE("a campaign ends wherever it is interrupted") {
  StudyFolder study;
  study.write();
  const TemporaryFolder folder;
  interrupt(
      [&](int k) {
        return std::vector<std::string>{
            "campaign", "run", study.path("study.json"), "--out", folder / std::to_string(k), "--workers", "2"};
      },
      3);
  check_nothing_half_written(folder.path());
}

TEST_CASE("training and scores end wherever they are interrupted and leave no half file") {
  const std::string dataset = kSource / "data/quarter_wheel_90mm/dataset.h5";
  const TemporaryFolder folder;
  write_file_atomically(
      folder / "study.json",
      R"({"study": "s", "seed": 1, "learning": {"hidden": 2, "epochs": 5, "folds": 2, "teacher": 0}})");
  interrupt(
      [&](int k) {
        const std::string study = folder / "study.json", out = folder / (std::to_string(k) + ".h5");
        return std::vector<std::string>{"train", "--dataset", dataset, "--study", study, "--out", out};
      },
      3);
  interrupt(
      [&](int k) {
        const std::string out = folder / ("scores" + std::to_string(k));
        return std::vector<std::string>{"evaluate", "--model", "quarter_wheel_90mm", "--out", out};
      },
      0);
  check_nothing_half_written(folder.path());
}

TEST_CASE("a trial and rows and weighed soil tests end wherever they are interrupted and leave no half file") {
  StudyFolder study;
  study.write();
  const TemporaryFolder folder;
  interrupt(
      [&](int k) {
        return std::vector<std::string>{"simulate", study.path("study.json"),
                                        "--set",    "slope_along=5",
                                        "--csv",    folder / (std::to_string(k) + ".trial.csv")};
      },
      1);
  interrupt(
      [&](int k) {
        return std::vector<std::string>{"sample",
                                        "--model",
                                        "hmmwv",
                                        "--rows",
                                        "4000",
                                        "--sampler",
                                        "tempering",
                                        "--burn-in",
                                        "400",
                                        "--out",
                                        folder / (std::to_string(k) + ".csv")};
      },
      5);
  interrupt(
      [&](int k) {
        const auto soil = folder / (std::to_string(k) + ".json");
        fs::copy_file(kSource / "configs/soils/sandy_loam.json", soil);
        return std::vector<std::string>{"soil", "fit", soil, "--calibration",
                                        kSource / "configs/soils/calibration_32mm.json"};
      },
      1);
  check_nothing_half_written(folder.path());
}

TEST_CASE("a calibration ends wherever it is interrupted and leaves no half table") {
  const TemporaryFolder folder;
  interrupt_early(
      [&](int k) {
        const std::string out = folder / (std::to_string(k) + ".json");
        return std::vector<std::string>{"soil", "calibrate", "--grain", "0.09", "--out", out, "--threads", "2"};
      },
      kUntilHandlers, 3);
  check_nothing_half_written(folder.path());
  for (const std::string& file : files_below(folder.path())) CHECK(file.find(".json.tests") != std::string::npos);
}

TEST_CASE("samples and learning curves and capacities end wherever they are interrupted and leave no half file") {
  const TemporaryFolder folder;
  const std::string problem = folder / "problem.json", dataset = kSource / "data/quarter_wheel_32mm/dataset.h5";
  REQUIRE(run_gonogo({"qubo", "export", "--model", "quarter_wheel_90mm", "--clamp", "slope_along=12", "--out", problem})
              .exit_code == 0);
  const std::vector<std::vector<std::string>> commands = {
      {"qubo", "sample", problem, "--reads", "1000000"},
      {"learning-curve", "--dataset", dataset},
      {"capacity", "--dataset", dataset},
  };
  for (std::size_t c = 0; c < commands.size(); ++c)
    interrupt_early(
        [&](int k) {
          std::vector<std::string> words = commands[c];
          words.insert(words.end(), {"--out", folder / (std::to_string(c) + "." + std::to_string(k) + ".json")});
          return words;
        },
        kUntilHandlers, 2);
  check_nothing_half_written(folder.path());
}

TEST_CASE("soil tests and validations end wherever they are interrupted") {
  const std::vector<std::vector<std::string>> commands = {
      {"soil", "test", "shear", "--grain", "0.032", "--friction", "0.5", "--rolling", "0.1"},
      {"validate", "elastic"},
      {"validate", "soils"},
  };
  for (const std::vector<std::string>& words : commands) interrupt_early([&](int) { return words; }, kUntilHandlers, 2);
}

TEST_CASE("a region ends wherever it is interrupted and leaves no half region") {
  constexpr int side = 600;
  const TemporaryFolder folder;
  test::RasterRecipe heights{.columns = side, .rows = side}, units = heights;
  for (int i = 0; i < side * side; ++i) {
    heights.value.push_back(float(100 + i % 47));
    units.value.push_back(float(464399 + i / 7 % 2));
  }
  test::make_raster(folder / "elevation.tif", heights);
  test::make_raster(folder / "mukey.tif", units);
  write_file_atomically(folder / "mukey.csv", "mukey,sandtotal_r,claytotal_r\n464399,40,20\n464400,92,3\n");
  interrupt(
      [&](int) {
        fs::remove(folder / "region.json");
        return std::vector<std::string>{"region", "make", folder.path()};
      },
      5);
  check_nothing_half_written(folder.path());
}

TEST_CASE("a limit on the size of files is told in a sentence and leaves no partial map") {
  StudyFolder study;
  study.write();
  for (const rlim_t bytes : {1000, 20'000, 100'000}) {
    const TemporaryFolder folder;
    std::vector<std::string> words = ground_words(study);
    words.insert(words.begin(), "map");
    words.insert(words.end(), {"--out", folder / "map"});
    RunOptions options;
    options.before = [bytes] {
      const rlimit limit{bytes, bytes};
      setrlimit(RLIMIT_FSIZE, &limit);
    };
    const Ending ending = run_gonogo(words, options);
    INFO(bytes << " " << ending.err);
    CHECK(ending.signal == 0);
    CHECK(ending.exit_code == 1);
    CHECK_FALSE(fs::exists(folder / "map/map.json"));
    CHECK_FALSE(fs::exists(folder / "map/index.html"));
    const Ending routed =
        run_gonogo({"route", "--model", "hmmwv", "--dem", study.path("elevation.asc"), "--soil", "sand, dry", "--from",
                    "730020,4368020", "--to", "730200,4368060", "--out", folder / "ways.gpkg"},
                   options);
    CHECK(routed.exit_code == (bytes < 100'000 ? 1 : routed.exit_code));
    if (routed.exit_code == 1) CHECK(contains(routed.err, "gonogo: " + (folder / "ways.gpkg").string() + ": cannot"));
    check_nothing_half_written(folder.path());
  }
}

}  // namespace gonogo
