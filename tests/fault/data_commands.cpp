// gonogo design and gonogo dataset: what they print, and what they answer to bad input.
#include <chrono>
#include <fstream>

#include "base/files/file.h"
#include "base/json/json.h"
#include "pipeline/campaign/dataset/row.h"
#include "tests/fault/cheap_campaign.h"
#include "tests/fault/program.h"
#include "tests/fault/study_folder.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/trials.h"

namespace gonogo::campaign {

namespace {

const std::string kStudy = R"({"study": "t", "seed": 3, "design": {"method": "sobol", "points": 20,
  "ranges": {"slope_along": [0, 35], "cohesion": [0, 5]},
  "fixed": {"slope_across": 0, "friction_angle": 30, "relative_density": 0.5, "payload": 0, "tyre_friction": 0.8,
            "bed_depth": 0.3, "commanded_speed": 1}}})";

Dataset sample() {
  const CampaignRequest request = cheap_campaign("unused", 50);
  Dataset dataset{.records = {}, .provenance = request.provenance};
  for (const DesignPoint& point : request.design) dataset.records.push_back(closed_form_trial(point));
  return dataset;
}

TEST_CASE("gonogo design prints every point and its coverage") {
  const TemporaryFolder folder;
  write_file_atomically(folder / "study.json", kStudy);
  const Ending csv = run_gonogo({"design", folder / "study.json", "--csv"});
  CHECK(csv.exit_code == 0);
  CHECK(std::count(csv.out.begin(), csv.out.end(), '\n') == 23);
  const Ending json = run_gonogo({"design", folder / "study.json", "--json"});
  CHECK(Json::parse(json.out, "stdout").at("trials").integer() == 22);
}

TEST_CASE("gonogo design refuses a misspelt variable with the nearest one") {
  const TemporaryFolder folder;
  std::string text = kStudy;
  text.replace(text.find("slope_along"), 11, "slope_alnog");
  write_file_atomically(folder / "study.json", text);
  check_refusal(run_gonogo({"design", folder / "study.json"}), 2,
                {"study.json", "design.ranges.slope_alnog", "did you mean \"slope_along\""});
}

TEST_CASE("gonogo design refuses what the study's campaign would refuse") {
  const auto check = [](const char* section, const char* key, const Json& value, const std::string& message) {
    StudyFolder s;
    s.study["trial"][section][key] = value;
    s.write();
    check_refusal(run_gonogo({"design", s.path("study.json")}), 2, {"study.json", message});
  };
  check("drive", "time_limit_s", -1, "trial.drive.time_limit_s: value -1 is outside the allowed range");
  check("numerics", "target", "culomb", "\"culomb\" is not one of: ccp, coulomb");
  StudyFolder s;
  s.study["compute"]["workers"] = 0;
  s.write();
  check_refusal(run_gonogo({"design", s.path("study.json")}), 2, {"compute.workers"});
  s.study["compute"]["workers"] = 1;
  s.write();
  CHECK(run_gonogo({"design", s.path("study.json")}).exit_code == 0);
}

TEST_CASE("gonogo dataset exports exactly the table") {
  const TemporaryFolder folder;
  const Dataset dataset = sample();
  write_dataset(folder / "d.h5", dataset);
  const std::string file = folder / "d.h5", out = folder / "d.csv";
  CHECK(run_gonogo({"dataset", "export", file, "--out", out}).exit_code == 0);
  CHECK(read_file(out) == to_csv(dataset));
  const Ending summary = run_gonogo({"dataset", "summary", file, "--json"});
  CHECK(Json::parse(summary.out, "stdout").at("trials").integer() == 55);
}

TEST_CASE("gonogo dataset merges, checks and compares") {
  const TemporaryFolder folder;
  const Dataset whole = sample();
  Dataset first = whole, second = whole;
  first.records.resize(30);
  second.records.erase(second.records.begin(), second.records.begin() + 20);
  const std::string a = folder / "a.h5", b = folder / "b.h5", w = folder / "w.h5", out = folder / "out.h5";
  write_dataset(a, first);
  write_dataset(b, second);
  write_dataset(w, whole);
  CHECK(run_gonogo({"dataset", "merge", a, b, "--out", out}).exit_code == 0);
  CHECK(read_file(out) == read_file(w));
  CHECK(run_gonogo({"dataset", "diff", out, w}).exit_code == 0);
  const Ending diff = run_gonogo({"dataset", "diff", a, w});
  CHECK(diff.exit_code == 1);
  CHECK(contains(diff.out, "only in the second"));
  CHECK(run_gonogo({"dataset", "verify", w}).exit_code == 0);
  first.records[4].attempts = 9;
  write_dataset(a, first);
  const Ending faults = run_gonogo({"dataset", "verify", a});
  CHECK(faults.exit_code == 1);
  CHECK(contains(faults.out, "trial 4: took 9 attempts"));
  second.records[2].measures[1] += 1;  // trial 22
  write_dataset(b, second);
  check_refusal(run_gonogo({"dataset", "merge", a, b, "--out", folder / "no.h5"}), 2, {"trial 22", "another result"});
  CHECK_FALSE(std::filesystem::exists(folder / "no.h5"));
}

TEST_CASE("gonogo dataset plot draws what it is asked for into a page that needs nothing else") {
  const TemporaryFolder folder;
  write_dataset(folder / "d.h5", sample());
  const std::string file = folder / "d.h5";
  const Ending drawn = run_gonogo({"dataset", "plot", file, "--out", folder / "plots", "--y", "sinkage"});
  INFO(drawn.err);
  REQUIRE(drawn.exit_code == 0);
  for (const char* name : {"boundary.png", "pairs.png"})
    CHECK(read_file(folder / "plots" / name).substr(1, 3) == "PNG");
  const std::string page = read_file(folder / "plots/report.html");
  CHECK(contains(page, "data:image/png;base64,iVBORw0KGgo"));
  CHECK_FALSE(contains(page, "://"));
  const Ending by_reason = run_gonogo({"dataset", "plot", file, "--out", folder / "reasons", "--by-reason"});
  REQUIRE(by_reason.exit_code == 0);
  CHECK(read_file(folder / "reasons/pairs.png") == read_file(folder / "plots/pairs.png"));
  CHECK(read_file(folder / "reasons/boundary.png") != read_file(folder / "plots/boundary.png"));
  check_refusal(run_gonogo({"dataset", "plot", file, "--out", folder / "none", "--x", "slope_allong"}), 2,
                {"slope_allong", "did you mean \"slope_along\""});
  CHECK_FALSE(std::filesystem::exists(folder / "none"));
}

TEST_CASE("gonogo dataset refuses what is no whole dataset, and exports whole files or none") {
  const TemporaryFolder folder;
  const std::string bytes = dataset_image(sample());
  std::ofstream(folder / "cut.h5", std::ios::binary) << bytes.substr(0, 5000);
  check_refusal(run_gonogo({"dataset", "summary", folder / "cut.h5"}), 2, {"cut.h5", "cut short"});
  check_refusal(run_gonogo({"dataset", "summary", folder / "none.h5"}), 2, {"none.h5", "no such file"});
  write_file_atomically(folder / "whole.h5", bytes);
  RunOptions full;
  full.before = [] { limit_file_size(1000); };
  check_refusal(run_gonogo({"dataset", "export", folder / "whole.h5", "--out", folder / "out.csv"}, full), 1,
                {"out.csv"});
  check_nothing_half_written(folder.path());
  CHECK_FALSE(std::filesystem::exists(folder / "out.csv"));
}

TEST_CASE("a dataset that crashes HDF5 1.10, or sends it into an endless loop, is refused in a sentence") {
  for (const std::string name : {"crashes_1_10.h5", "never_ends_1_10.h5"}) {
    const auto start = std::chrono::steady_clock::now();
    const Ending ending = run_gonogo({"dataset", "summary", std::string(GONOGO_SOURCE_DIR "/tests/data/hdf5/") + name});
    CHECK(ending.signal == 0);
    check_refusal(ending, 2, {name});
    CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(30));
  }
}

}  // namespace
}  // namespace gonogo::campaign
