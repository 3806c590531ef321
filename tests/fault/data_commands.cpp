// gonogo design and gonogo dataset: what they print, and what they answer to bad input.
#include <fstream>

#include "base/file.h"
#include "base/json/json.h"
#include "pipeline/dataset/export.h"
#include "tests/fault/cheap_campaign.h"
#include "tests/fault/program.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/trials.h"

namespace gonogo::pipeline {
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

}  // namespace
}  // namespace gonogo::pipeline
