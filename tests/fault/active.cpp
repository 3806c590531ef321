// A study that chooses its own trials, and how much of a region a design's box holds: both by the built program.
#include <sstream>

#include "base/files/file.h"
#include "tests/fault/program.h"
#include "tests/fault/study_folder.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"

namespace gonogo {
namespace fs = std::filesystem;
namespace {

std::vector<std::string> lines_of(const fs::path& file) {
  std::istringstream in(read_file(file));
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

Json active(const StudyFolder& s, const std::string& max_points) {
  const Ending ending =
      run_gonogo({"--json", "--threads", "2", "campaign", "active", s.path("study.json"), "--out", s.out(), "--seeds",
                  "4", "--batch", "2", "--max-points", max_points, "--confidence", "1"});
  INFO(ending.err);
  REQUIRE(ending.exit_code == 0);
  return Json::parse(ending.out, "answer");
}

double share(const StudyFolder& s) {
  const Ending ending = run_gonogo({"--json", "design", s.path("study.json")});
  INFO(ending.err);
  REQUIRE(ending.exit_code == 0);
  return Json::parse(ending.out, "answer").at("region_share").number();
}

}  // namespace

TEST_CASE(
    "a study chooses its own trials after the seeds, goes on where it was, and keeps the density of each choice") {
  const StudyFolder s;
  s.write();
  const Json first = active(s, "6");
  CHECK(first.at("points").integer() == 6);
  CHECK(first.at("computed").integer() == 6);
  const auto table = lines_of(s.out() / "points.csv");
  REQUIRE(table.size() == 7);
  CHECK(table[0] == "slope_along,friction_angle,proposal_density");
  const auto density = [](const std::string& row) { return std::stod(row.substr(row.rfind(',') + 1)); };
  for (int i = 1; i <= 4; ++i) CHECK(density(table[i]) == 1);
  for (int i = 5; i <= 6; ++i) {
    CHECK(density(table[i]) >= 0.25);  // the share of space filling
    CHECK(density(table[i]) != 1);
  }
  CHECK(active(s, "6").at("computed").integer() == 0);
  CHECK(Json::read(s.out() / "study.json").at("learning").at("importance").number() == 0);  // the study names none

  const Json more = active(s, "7");
  CHECK(more.at("computed").integer() == 1);
  CHECK(more.at("reused").integer() == 6);
  const auto longer = lines_of(s.out() / "points.csv");
  REQUIRE(longer.size() == 8);
  CHECK(std::equal(table.begin(), table.end(), longer.begin()));
  const Ending summary = run_gonogo({"--json", "dataset", "summary", s.out() / "dataset.h5"});
  CHECK(Json::parse(summary.out, "answer").at("trials").integer() == 7);
}

TEST_CASE("the share of a ramp whose slope lies inside the sampled box") {
  StudyFolder s;  // slopes grow evenly from 0 to 35 degrees
  s.write();
  CHECK(share(s) > 0.99);
  s.study["design"]["ranges"]["slope_along"] = std::vector<double>{0, 17.5};
  s.write();
  CHECK(share(s) == Approx(0.5).margin(0.03));
}

}  // namespace gonogo
