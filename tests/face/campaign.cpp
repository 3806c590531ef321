#include <gonogo/campaign.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include "tests/support/catch.h"

using namespace gonogo::api;

namespace {

const std::filesystem::path kRoot = GONOGO_SOURCE_DIR;

struct Folder {
  std::filesystem::path path = std::filesystem::temp_directory_path() / "gonogo_face_campaign";
  Folder() {
    std::filesystem::remove_all(path);
    std::filesystem::create_directories(path);
  }
  ~Folder() { std::filesystem::remove_all(path); }
};

/// A study of two short trials on a level, firm bed.
std::filesystem::path short_study(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "study.json";
  const std::string configs = (kRoot / "configs").string();
  std::ofstream(file) << R"({"study": "short", "seed": 1, "vehicle": ")" << configs
                      << R"(/vehicles/hmmwv_quarter.json", "soil": {"calibration": ")" << configs
                      << R"(/soils/calibration_90mm.json"},
    "trial": {"bed": {"length_m": 1.8, "width_m": 0.7, "packing_seeds": 1, "settle_s": 0.1},
      "drive": {"park_s": 0.1, "ramp_s": 0.05, "run_in_m": 0.1, "test_distance_m": 0.2, "minimum_drive_s": 0.1, "time_limit_s": 2}},
    "design": {"method": "sobol", "points": 2, "replicate_every": 0, "ranges": {"slope_along": [-2, 2]},
      "fixed": {"slope_across": 0, "friction_angle": 38, "cohesion": 0, "relative_density": 0.5, "payload": 0,
        "tyre_friction": 0.8, "bed_depth": 0.25, "commanded_speed": 1}}})";
  return file;
}

}  // namespace

TEST_CASE("the face names variables, measures and outcomes of trials") {
  const auto all = variables();
  const auto slope = std::find_if(all.begin(), all.end(), [](const Quantity& v) { return v.name == "slope_along"; });
  REQUIRE(slope != all.end());
  CHECK(slope->range.low < 0);
  CHECK(slope->range.high > 30);
  CHECK_FALSE(slope->unit.empty());
  CHECK_FALSE(measures().empty());
  CHECK(outcomes().front() == "go");
  CHECK(name_of(Verdict::no_go) == "no_go");
  CHECK_FALSE(label_of(Verdict::slow_go).empty());
  CHECK(design("demo").size() == 88);
}

TEST_CASE("a dataset of the face has a row and a column for all that its file holds") {
  const Dataset dataset = Dataset::read(kRoot / "data/quarter_wheel_90mm/dataset.h5");
  std::size_t sum = 0;
  for (const auto& [verdict, count] : dataset.verdicts()) sum += count;
  CHECK(sum == dataset.size());
  const auto slopes = dataset.column("slope_along"), slips = dataset.column("slip");
  REQUIRE(slopes.size() == dataset.size());
  const TrialResult trial = dataset.trial(3);
  CHECK(trial.variables.at("slope_along") == slopes[3]);
  CHECK((trial.measures.at("slip") == slips[3] || std::isnan(slips[3])));
  const std::string csv = dataset.csv();
  CHECK(std::size_t(std::count(csv.begin(), csv.end(), '\n')) == dataset.size() + 1);
  CHECK_THROWS_AS(dataset.trial(dataset.size()), InputError);
  CHECK_THROWS_AS(dataset.column("slope"), InputError);
}

TEST_CASE("a campaign of the face computes a study once, with the bits of its single trials") {
  const Folder folder;
  const std::string study = short_study(folder.path).string();
  CampaignRequest request{.study = study, .folder = folder.path / "trials", .workers = 2, .program = GONOGO_PROGRAM};
  const CampaignSummary first = run_campaign(request);
  CHECK(first.trials == 2);
  CHECK(first.computed == 2);
  CHECK(run_campaign(request).reused == 2);
  const CampaignStatus status = campaign_status(request.folder);
  CHECK(status.done == 2);
  CHECK_FALSE(status.running);

  const TrialResult row = Dataset::read(first.dataset).trial(0);
  std::size_t steps = 0;
  const Trial trial = Trial::of_study(study, {{"slope_along", row.variables.at("slope_along")}}, row.seed);
  const TrialResult alone = trial.run({.threads = 2,
                                       .on_step = [&](const TrialMoment&) { ++steps; },
                                       .frames = folder.path / "frames",
                                       .frame_interval = 0.5});
  CHECK(alone.verdict == row.verdict);
  CHECK(alone.reason == row.reason);
  for (const auto& [name, value] : row.measures)
    CHECK((alone.measures.at(name) == value || (std::isnan(value) && std::isnan(alone.measures.at(name)))));
  CHECK(steps > 20);
  CHECK(std::filesystem::exists(folder.path / "frames" / "spheres.pvd"));
}

TEST_CASE("a trial of a vehicle without a study takes usual values, and refuses others by name") {
  const Trial trial = Trial::of_vehicle("hmmwv_quarter", "calibration_90mm", {{"slope_along", 4}});
  CHECK(trial.variables().at("slope_along") == 4);
  CHECK(trial.variables().at("commanded_speed") == 1.5);
  CHECK_THROWS_AS(Trial::of_vehicle("hmmwv_quarter", "calibration_90mm", {{"slope", 4}}), InputError);
  CHECK_THROWS_AS(Trial::of_study("demo", {{"slope_along", 400}}), InputError);
}
