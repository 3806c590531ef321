#include <gonogo/learn.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "tests/support/catch.h"

using namespace gonogo::api;

TEST_CASE("a model of the face falls with the slope, and answers tables as points") {
  const Model model = Model::read("quarter_wheel_90mm");
  CHECK(model.p_go({{"slope_along", 0}}) > 0.8);
  CHECK(model.p_go({{"slope_along", 30}}) < 0.2);
  CHECK(model.gravity() == Approx(9.81).margin(0.01));
  CHECK(model.sampled().at("slope_along").high > 20);
  CHECK(std::filesystem::exists(model.file()));

  const auto all = variables();
  std::vector<double> points(2 * all.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t v = 0; v < all.size(); ++v)
    if (all[v].name == "slope_along") points[v] = 5, points[all.size() + v] = 15;
  const auto p = model.p_go(points);
  REQUIRE(p.size() == 2);
  CHECK(p[0] == model.p_go({{"slope_along", 5}}));
  CHECK(p[1] == model.p_go({{"slope_along", 15}}));
  CHECK_THROWS_AS(model.p_go({{"slope", 5}}), InputError);
  CHECK_THROWS_AS(model.p_go({{"slope_along", 500}}), InputError);
  CHECK_THROWS_AS(model.p_go(std::vector<double>(3)), InputError);
  CHECK_THROWS_AS(Model::read("no_such_model"), InputError);
}

TEST_CASE("an answer of the face has chances that sum to one, and what is not known") {
  const Model model = Model::read("quarter_wheel_90mm");
  const Answer answer = model.ask({{"slope_along", 12}}, "", true);
  double sum = 0, go = 0;
  for (const OutcomeChance& o : answer.outcomes) {
    sum += o.probability;
    if (o.name == "go" || o.name == "slow_go") go += o.probability;
  }
  CHECK(sum == Approx(1));
  CHECK(answer.p_go == Approx(go));
  CHECK(answer.outside.empty());
  CHECK_FALSE(answer.unknown.empty());
  for (const Unknown& u : answer.unknown) CHECK(u.interval.low <= u.interval.high);
  CHECK(model.ask({{"slope_along", -44}}).outside == "slope_along");
}

TEST_CASE("rows of the face pass as often as the machine says") {
  const SampledRows rows =
      Model::read("quarter_wheel_90mm").sample({.rows = 2000, .known = {{"slope_along", 30}}, .seed = 2});
  CHECK(rows.outcome.size() == 2000);
  CHECK(rows.values.size() == 2000 * rows.columns.size());
  const auto passed = std::count_if(rows.outcome.begin(), rows.outcome.end(),
                                    [](const std::string& o) { return o == "go" || o == "slow_go"; });
  CHECK(double(passed) / 2000 < 0.3);
  CHECK(rows.effective_rows > 200);
}

TEST_CASE("a model that the face trains beats the base rate on trials that it has not seen") {
  const auto folder = std::filesystem::temp_directory_path() / "gonogo_face_learn";
  std::filesystem::create_directories(folder);
  const std::filesystem::path dataset = std::filesystem::path(GONOGO_SOURCE_DIR) / "data/quarter_wheel_90mm/dataset.h5";
  const TrainReport report = train({.dataset = dataset, .model = folder / "model.h5", .seed = 4, .hold_out = 60});
  CHECK(report.held_out == 60);
  CHECK(report.trained_on + report.unknown + report.held_out == report.trials);
  REQUIRE(report.scores.front().of == "model");
  CHECK_FALSE(report.text.empty());
  const Evaluation evaluation = evaluate((folder / "model.h5").string(), dataset);
  std::filesystem::remove_all(folder);
  CHECK(evaluation.trials == 60);
  CHECK_FALSE(evaluation.checks.empty());
  CHECK_FALSE(evaluation.text.empty());
  const Score& base = evaluation.scores.back();
  CHECK(base.of == "base_rate");
  CHECK(evaluation.scores.front().brier_score < base.brier_score);
  CHECK(evaluation.scores.front().brier.low <= evaluation.scores.front().brier_score);
}

TEST_CASE("the face asks the family of the vehicle that trials drove, and no family has a wheel by itself") {
  const std::filesystem::path dataset = std::filesystem::path(GONOGO_SOURCE_DIR) / "data/quarter_wheel_90mm/dataset.h5";
  for (const char* family : {"", "wheeled_family_32mm"})
    CHECK_THROWS_WITH(train({.dataset = dataset, .model = "never.h5", .family = family}),
                      "hmmwv_quarter: the family has whole wheeled vehicles, and this is a wheel by itself");
}
