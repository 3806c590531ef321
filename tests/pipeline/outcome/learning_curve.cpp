// Learning curves, and the reconstruction of hidden inputs.
#include "pipeline/outcome/active/learning_curve.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <set>

#include "base/files/file.h"
#include "learning/score/score.h"
#include "pipeline/outcome/answer/predictor.h"
#include "pipeline/outcome/evaluation/hidden_inputs.h"
#include "pipeline/outcome/evaluation/scores.h"
#include "pipeline/outcome/training/teacher.h"
#include "tests/pipeline/outcome/trained_model.h"
#include "tests/support/catch.h"
#include "tests/support/refused.h"

using namespace gonogo;
using namespace gonogo::outcome;
namespace fs = std::filesystem;

namespace {

std::optional<Config> section(const std::string& text) { return Config::parse(text, "test"); }

LearningCurveRequest small_request(const std::string& folder) {
  LearningCurveRequest request;
  request.training = {.dataset = model_dataset(),
                      .model = {},
                      .seed = 3,
                      .learning = section(R"({"epochs": 20, "folds": 2})"),
                      .design = {},
                      .hold_out = 40};
  request.trials = {20, 40};
  request.subsets = 2;
  request.folder = scratch() / folder;
  return request;
}

/// Points uniform over the model's box with outcomes drawn from its own P(outcome | variables).
learning::TrainingTable drawn_from(const Predictor& predictor, std::size_t rows, std::uint64_t seed) {
  const learning::Model& model = predictor.model();
  learning::TrainingTable table;
  table.variable_count = model.layout.variable_count();
  for (std::size_t n = 0; n < rows; ++n) {
    std::vector<double> x;
    for (std::size_t v = 0; v < table.variable_count; ++v)
      x.push_back(model.sampled_lower[v] + (model.sampled_upper[v] - model.sampled_lower[v]) * random_unit(seed, n, v));
    const std::vector<double> p = predictor.outcome_probabilities(x);
    std::size_t y = 0;
    for (double u = random_unit(seed, n, 99) - p[0]; u >= 0 && y + 1 < p.size();) u -= p[++y];
    table.variables.insert(table.variables.end(), x.begin(), x.end());
    table.outcome.push_back(y);
    table.weight.push_back(1);
    table.group.push_back(n);
  }
  return table;
}

}  // namespace

TEST_CASE("a learning curve scores each subset once, goes on where it was, and starts anew for other inputs") {
  LearningCurveRequest request = small_request("curve");
  const LearningCurve curve = learning_curve(request);
  REQUIRE(curve.points.size() == 4);
  const CurvePoint& first = curve.points.front();
  CHECK(first.brier.size() == 1 + std::size(kBaselines));
  // The model file of a subset, asked again: the same score on the same held-out trials.
  const Predictor predictor = Predictor::read(request.folder / "trials_20_subset_1" / "model.h5");
  CHECK(predictor.model().training_outcomes.size() >= 20);
  CHECK(predictor.model().training_outcomes.size() <= 21);
  TrainingData data = make_training_data(campaign::read_dataset(model_dataset()).records, {});
  const learning::TrainingTable held_out = hold_out(data, 40, 3);
  double brier = 0;
  for (std::size_t n = 0; n < held_out.row_count(); ++n)
    brier += std::pow(predictor.p_go(held_out.row(n)) - passable_outcomes()[held_out.outcome[n]], 2);
  CHECK(first.brier.at("model") == Approx(brier / double(held_out.row_count())));

  fs::remove(request.folder / "trials_40_subset_2" / "scores.json");
  const auto untouched = fs::last_write_time(request.folder / "trials_20_subset_2" / "model.h5");
  const LearningCurve again = learning_curve(request);
  CHECK(fs::last_write_time(request.folder / "trials_20_subset_2" / "model.h5") == untouched);
  CHECK(to_json(again).dump() == to_json(curve).dump());
  CHECK(read_file(request.folder / "learning_curve.json") == to_json(curve).dump(2) + "\n");
  request.training.seed = 4;

  {  // Another process trains this one: it is left to it.
    const fs::path taken = request.folder / "trials_40_subset_1";
    const FileLock other = lock_folder(taken);
    const LearningCurve rest = learning_curve(request);
    CHECK(rest.key != curve.key);
    CHECK(rest.points.size() == 3);
    CHECK(rest.elsewhere == 1);
    CHECK(learning_curve_text(rest).find("still training: 1") != std::string::npos);
  }

  const std::string text = learning_curve_text(curve);
  CHECK(text.find("best") != std::string::npos);
  for (const fs::path& written : write_learning_curve(request.folder, curve)) CHECK(fs::file_size(written) > 100);
}

TEST_CASE(
    "the trials of an active curve grow where the smaller model is unsure, and each number holds the one before") {
  // 1,000 points of one variable, every tenth twice. The model is unsure below 0.1: w = 1 there and 0 elsewhere.
  learning::TrainingTable table;
  table.variable_count = 1;
  for (std::uint64_t i = 0; i < 1000; ++i)
    for (std::uint64_t copy = 0; copy < (i % 10 == 0 ? 2 : 1); ++copy) {
      table.variables.push_back((double(i) + 0.5) / 1000);
      table.outcome.push_back(0);
      table.weight.push_back(1);
      table.group.push_back(i);
    }
  const ModelAnswers model{.p_go =
                               [](std::span<const double> x, std::span<double> p) {
                                 for (std::size_t i = 0; i < x.size(); ++i) p[i] = x[i] < 0.1 ? 0.5 : 1;
                               },
                           .novelty = [](std::span<const double>) { return 1.0; }};
  const std::vector<std::uint64_t> taken = drawn_groups(table, 20, 1);
  double unsure = 0, drawn = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const std::vector<std::uint64_t> groups = grown_groups(table, taken, 60, model, seed);
    CHECK(std::is_sorted(groups.begin(), groups.end()));
    CHECK(std::adjacent_find(groups.begin(), groups.end()) == groups.end());
    CHECK(std::includes(groups.begin(), groups.end(), taken.begin(), taken.end()));
    std::size_t rows = 0;
    for (const std::uint64_t g : groups) rows += g % 10 == 0 ? 2 : 1;
    CHECK((rows == 60 || rows == 61));
    drawn += double(groups.size() - taken.size());
    for (const std::uint64_t g : groups) unsure += g < 100 && !std::binary_search(taken.begin(), taken.end(), g);
  }
  // A tenth of the points has 0.25 * 0.1 + 0.75 of the density: 0.775 of the first draw. 40 draws of 100 points leave
  // fewer there, and the share falls to about 0.68: after k draws of which a are there, the next one is there with the
  // chance 7.75 (100 - a) / (7.75 (100 - a) + 0.25 (900 - (k - a))).
  double expected = 0;
  for (int k = 0; k < 38; ++k) {
    const double there = 7.75 * (98 - expected);
    expected += there / (there + 0.25 * (882 - (k - expected)));
  }
  std::printf("share of the draws where the model is unsure: %.3f, expected %.3f\n", unsure / drawn, expected / 38);
  CHECK(unsure / drawn == Approx(expected / 38).margin(0.03));
}

TEST_CASE("an active curve begins with the drawn trials and adds to them") {
  LearningCurveRequest request = small_request("active");
  request.trials = {40, 20};
  request.subsets = 1;
  const LearningCurve drawn = learning_curve(request);
  request.active = true;
  request.folder = scratch() / "active_too";
  const LearningCurve active = learning_curve(request);
  REQUIRE(active.points.size() == 2);
  CHECK(active.points.front().trials == 20);
  CHECK(active.points.front().brier == drawn.points.back().brier);
  CHECK(active.points.back().brier != drawn.points.front().brier);
  const auto points = [&](const char* place) {
    const learning::Model model = learning::read_model(request.folder / place / "model.h5");
    std::set<std::vector<double>> rows;
    const std::size_t width = model.layout.variable_count();
    for (std::size_t i = 0; i + width <= model.training_points.size(); i += width)
      rows.emplace(model.training_points.begin() + std::ptrdiff_t(i),
                   model.training_points.begin() + std::ptrdiff_t(i + width));
    return rows;
  };
  const auto few = points("trials_20_subset_1"), more = points("trials_40_subset_1");
  CHECK(more.size() > few.size());
  CHECK(std::includes(more.begin(), more.end(), few.begin(), few.end()));
  CHECK(to_json(learning_curve(request)).dump() == to_json(active).dump());
}

TEST_CASE("an active curve that starts from a forecast draws its first trials where that is unsure") {
  LearningCurveRequest request = small_request("forecast");
  request.trials = {20};
  request.subsets = 4;
  const std::size_t slope = campaign::contract().variable_index("slope_along"),
                    width = campaign::contract().variables.size();
  const learning::TrainingTable all = make_training_data(campaign::read_dataset(model_dataset()).records, {}).table;
  std::vector<double> slopes;
  for (std::size_t n = 0; n < all.row_count(); ++n) slopes.push_back(all.row(n)[slope]);
  std::nth_element(slopes.begin(), slopes.begin() + std::ptrdiff_t(slopes.size() / 2), slopes.end());
  const double middle = slopes[slopes.size() / 2];
  request.training.forecast = std::make_shared<const Forecast>(
      Forecast{.hash = "h", .about = "a family", .trials = 9, .p_go = [=](const std::vector<double>& points) {
                 std::vector<double> p;
                 for (std::size_t n = slope; n < points.size(); n += width)
                   p.push_back(points[n] < middle ? 0.999 : 0.5);
                 return p;
               }});
  const auto steep = [&] {  // share of the trials
    double count = 0, points = 0;
    learning_curve(request);
    for (int k = 1; k <= 4; ++k) {
      const auto place = request.folder / ("trials_20_subset_" + std::to_string(k)) / "model.h5";
      const learning::Model model = learning::read_model(place);
      for (std::size_t i = slope; i < model.training_points.size(); i += width) {
        count += model.training_points[i] >= middle;
        ++points;
      }
    }
    return count / points;
  };
  const double drawn = steep();
  request.active = true;
  request.folder = scratch() / "forecast_active";
  const double chosen = steep();
  std::printf("share of the trials on steep slopes, where the forecast is unsure: drawn %.2f, chosen %.2f\n", drawn,
              chosen);
  CHECK(chosen > 0.75);
  CHECK(drawn < 0.7);
}

TEST_CASE("a learning curve refuses numbers of trials that there are not") {
  LearningCurveRequest request = small_request("refused");
  request.trials = {20, 90};
  refused([&] { learning_curve(request); }, "90 trials to train on; give a number between 10 and");
  request.trials = {};
  refused([&] { learning_curve(request); }, "one number of trials");
  request = small_request("refused");
  request.training.hold_out = 0;
  refused([&] { learning_curve(request); }, "hold trials out");
  CHECK_FALSE(fs::exists(request.folder));
}

TEST_CASE("the teacher helps few trials, its weight is a setting, and the same seed gives the same bytes") {
  const fs::path data = dataset_file("few.h5", 60, 8);
  const auto trained = [&](const std::string& name, const std::string& learning) {
    fs::path file = scratch() / (name + ".h5");
    train_model({.dataset = data, .model = file, .seed = 3, .learning = section(learning), .design = {}});
    return file;
  };
  const auto error = [&](const fs::path& file) {  // against the true probabilities
    const Predictor predictor = Predictor::read(file);
    double sum = 0;
    for (const auto& record : synthetic_trials(1000, 91)) {
      const auto& x = record.point.variables;
      sum += std::pow(predictor.p_go(x) - synthetic_p_go(x[0], x[2]), 2) / 1000;
    }
    return sum;
  };
  const double alone = error(trained("alone", R"({"teacher": 0})")), taught = error(trained("taught", "{}"));
  std::printf("60 trials, mean square error of P(go): alone %.4f, taught %.4f\n", alone, taught);
  CHECK(taught < 1.05 * alone);
  CHECK(read_file(trained("again", "{}")) == read_file(scratch() / "taught.h5"));
  CHECK(learning::read_model(scratch() / "taught.h5").provenance.at("teacher_weight").number() ==
        teacher_share({}).weight);
  refused([&] { read_learning_settings(section(R"({"teacher": -1})")); }, "teacher");
}

TEST_CASE("rows drawn from the model itself lie in its intervals as often as these promise") {
  const Predictor predictor = Predictor::read(model_file());
  const learning::TrainingTable own = drawn_from(predictor, 250, 12);
  const Reconstruction scores = reconstruction_scores(predictor, own);
  std::printf("%s", reconstruction_text(scores).c_str());
  CHECK(scores.pairs == 21);
  CHECK(scores.coverage.value == Approx(0.9).margin(0.025));
  CHECK(scores.gain.low > 0);
  const Json variables = to_json(scores).at("variables");
  CHECK(variables.at("slope_along").at("gain_nat").number() > variables.at("payload").at("gain_nat").number());
  // Outcomes of other rows mislead: what they say about slope and friction is wrong.
  learning::TrainingTable wrong = own;
  std::rotate(wrong.outcome.begin(), wrong.outcome.begin() + 1, wrong.outcome.end());
  CHECK(reconstruction_scores(predictor, wrong).gain.value < scores.gain.low);
}
