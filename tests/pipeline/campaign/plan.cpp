#include "pipeline/campaign/engine/study_campaign.h"

#include <map>

#include "base/files/file.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"

namespace gonogo::campaign {

namespace {

const std::string kStudy = R"({
  "study": "test", "seed": 5, "vehicle": "vehicle.json",
  "trial": {"step_s": 0.001, "limits": {"slip": 0.6}},
  "design": {"method": "sobol", "points": 20, "ranges": {"slope_along": [0, 35]},
             "fixed": {"slope_across": 0, "friction_angle": 30, "cohesion": 0, "relative_density": 0.5, "payload": 0,
                       "tyre_friction": 0.8, "bed_depth": 0.3, "commanded_speed": 1}},
  "map": {"step": 1}
})";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

struct Place {
  TemporaryFolder folder;
  Place() { write_file_atomically(folder / "vehicle.json", "{}"); }
  CampaignRequest plan(const std::string& study) const {
    write_file_atomically(folder / "study.json", study);
    return plan_campaign(read_study(folder / "study.json"), folder / "out", 2, {{"table", folder / "vehicle.json"}});
  }
};

std::string differing(const CampaignRequest& a, const CampaignRequest& b) {
  const std::map<std::string, std::string> before(a.depends_on.begin(), a.depends_on.end());
  std::string names;
  for (const auto& [name, value] : b.depends_on)
    if (!before.count(name) || before.at(name) != value) names += name + " ";
  return names;
}

TEST_CASE("trials depend on seed, soil, trial, design and files, by name") {
  const Place place;
  const CampaignRequest plan = place.plan(kStudy);
  CHECK(plan.design.size() == 22);
  CHECK(differing(plan, place.plan(replaced(kStudy, "\"slip\": 0.6", "\"slip\": 0.7"))) == "trial.limits.slip ");
  CHECK(differing(plan, place.plan(replaced(kStudy, "\"seed\": 5", "\"seed\": 6"))) == "seed ");
  CHECK(differing(plan, place.plan(replaced(kStudy, "[0, 35]", "[0, 30]"))) == "design.ranges.slope_along ");
  write_file_atomically(place.folder / "vehicle.json", "{ }");
  CHECK(differing(plan, place.plan(kStudy)) == "content of vehicle content of table ");
}

TEST_CASE("the number of points and what trials do not read may change") {
  const Place place;
  const CampaignRequest plan = place.plan(kStudy);
  CHECK(differing(plan, place.plan(replaced(kStudy, "\"points\": 20", "\"points\": 40"))).empty());
  const CampaignRequest other_map = place.plan(replaced(kStudy, "\"step\": 1", "\"step\": 2"));
  CHECK(differing(plan, other_map).empty());
  CHECK(other_map.provenance == plan.provenance);
}

TEST_CASE("provenance: study as it was, hashes of the files' bytes") {
  const Place place;
  const Provenance provenance = place.plan(kStudy).provenance;
  const Json study = Json::parse(provenance.study, "provenance");
  CHECK(study.at("trial").at("limits").at("slip").number() == 0.6);
  CHECK(study.find("map") == nullptr);
  CHECK(provenance.inputs == Provenance::Pairs{{"vehicle", content_hash("{}")}, {"table", content_hash("{}")}});
  CHECK(provenance.contract_hash == content_hash(contract_text()));
}

TEST_CASE("a missing vehicle or design section is one sentence") {
  const Place place;
  CHECK(contains(input_error([&] { place.plan(replaced(kStudy, "vehicle.json", "waggon.json")); }), "waggon.json"));
  CHECK(contains(input_error([&] { place.plan(R"({"study": "t", "seed": 1})"); }), "design"));
}

}  // namespace
TEST_CASE("a campaign takes the GPUs that it asks for if they are there and alike") {
  const std::vector<std::string> names{"H200", "H200", "A100"};
  CHECK(alike_gpus(names, 2) == std::vector<std::string>{"H200", "H200"});
  CHECK(alike_gpus({"A100", "A100"}, std::nullopt).size() == 2);
  CHECK(contains(input_error([&] { alike_gpus(names, std::nullopt); }), "GPUs of two kinds (H200, A100)"));
  CHECK(contains(input_error([&] { alike_gpus(names, 4); }), "on 4 GPUs; this machine has 3"));
  CHECK(contains(input_error([&] { alike_gpus({}, 1); }), "this build or machine has none; take --device cpu"));
}

}  // namespace gonogo::campaign
