// What a trained model answers: points, tables, conversations, scores.
#include <omp.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "base/files/file.h"
#include "learning/score/score.h"
#include "pipeline/outcome/answer/infer.h"
#include "pipeline/outcome/answer/predictor.h"
#include "pipeline/outcome/evaluation/evaluate_model.h"
#include "pipeline/outcome/evaluation/scores.h"
#include "tests/pipeline/outcome/trained_model.h"
#include "tests/support/catch.h"
#include "tests/support/refused.h"

using namespace gonogo;
using namespace gonogo::campaign;
using namespace gonogo::outcome;
namespace fs = std::filesystem;

TEST_CASE("a model trained on a hundred trials predicts fresh ones") {
  const Predictor predictor = Predictor::read(model_file());
  const auto fresh = synthetic_trials(2000, 77);
  std::vector<double> points, p;
  std::vector<int> go;
  double base = 0;
  for (const TrialRecord& record : fresh) {
    if (record.verdict == Verdict::unknown) continue;
    points.insert(points.end(), record.point.variables.begin(), record.point.variables.end());
    go.push_back(record.verdict != Verdict::no_go);
    base += go.back();
  }
  base /= double(go.size());
  p.resize(go.size());
  predictor.p_go(points, p);
  const double brier = learning::brier_score(p, go);
  std::printf("Brier on fresh trials %.4f, base rate %.4f\n", brier, base * (1 - base));
  CHECK(brier < 0.65 * base * (1 - base));

  std::vector<double> x = middle_point();
  double last = 1;
  for (x[0] = 0; x[0] <= 35; x[0] += 0.5) {
    CHECK(predictor.p_go(x) < last + 0.005);
    last = predictor.p_go(x);
  }
  const auto all = predictor.outcome_probabilities(x);
  double sum = 0;
  for (double q : all) sum += q;
  CHECK(sum == Approx(1));
}

TEST_CASE("batches give the bits of single points for any number of threads, also with unknown variables") {
  const Predictor predictor = Predictor::read(model_file());
  std::vector<double> points;
  for (int n = 0; n < 700; ++n) {
    auto x = middle_point();
    x[0] = n * 0.05;
    if (n % 7 == 0) x[4] = NAN;
    if (n % 70 == 0) x[3] = x[7] = NAN;
    points.insert(points.end(), x.begin(), x.end());
  }
  const std::size_t outcomes = contract().outcomes.size();
  std::vector<double> one(700), two(700), table(700 * outcomes);
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  predictor.p_go(points, one);
  omp_set_num_threads(2);
  predictor.p_go(points, two);
  predictor.outcome_probabilities(points, table);
  omp_set_num_threads(threads);
  CHECK(one == two);
  const auto point = std::span(points).subspan(middle_point().size() * 70, middle_point().size());
  CHECK(predictor.p_go(point) == one[70]);
  CHECK(predictor.outcome_probabilities(point) == std::vector<double>(table.begin() + std::ptrdiff_t(70 * outcomes),
                                                                      table.begin() + std::ptrdiff_t(71 * outcomes)));
}

TEST_CASE("a million points are answered at a rate that suits a map") {
  const Predictor predictor = Predictor::read(model_file());
  std::vector<double> points, p(200000);
  for (std::size_t n = 0; n < p.size(); ++n) {
    auto x = middle_point();
    x[0] = double(n % 1000) * 0.035;
    x[2] = 20 + double(n % 997) * 0.025;
    points.insert(points.end(), x.begin(), x.end());
  }
  const auto start = std::chrono::steady_clock::now();
  predictor.p_go(points, p);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::printf("%.0f points per second on %d threads\n", double(p.size()) / seconds, omp_get_max_threads());
  CHECK(double(p.size()) / seconds > 100000);
}

TEST_CASE("what lies outside the sampled box is said by variable, and novelty grows away from trials") {
  const Predictor predictor = Predictor::read(model_file());
  auto x = middle_point();
  CHECK(predictor.inside_sampled_box(x));
  x[7] = 0.5;
  CHECK(predictor.outside_variable(x) == "bed_depth");
  x[7] = NAN;
  CHECK(predictor.inside_sampled_box(x));
  const double inside = predictor.novelty(x);
  x[0] = -40;
  CHECK(predictor.outside_variable(x) == "slope_along");
  CHECK(predictor.novelty(x) > 2 * inside);
  const auto& model = predictor.model();
  CHECK(predictor.novelty(std::span(model.training_points).first(9)) == 0);
}

TEST_CASE("evaluation scores unseen trials only, beside the baselines") {
  const Evaluation evaluation = evaluate_model(model_file(), dataset_file("fresh.h5", 400, 55));
  const Json report = to_json(evaluation);
  CHECK(report.at("left_out_trained_on").integer() == 0);
  const Json& scores = report.at("scores");
  CHECK(scores.at("model").at("brier").number() < 0.7 * scores.at("base_rate").at("brier").number());
  CHECK(scores.at("model").at("brier").number() < scores.at("logistic_regression").at("brier").number() + 0.02);
  CHECK(scores.at("model").at("floor_brier_mean").number() > 0);
  const Json& model = scores.at("model");
  CHECK(model.at("brier_low").number() < model.at("brier").number());
  CHECK(model.at("brier_high").number() > model.at("brier").number());
  CHECK(model.at("calibration_slope").number() == Approx(1).margin(4 * model.at("calibration_slope_error").number()));
  CHECK(scores.at("neural_network").at("brier").number() < 0.7 * scores.at("base_rate").at("brier").number());
  CHECK(scores.at("gaussian_process").at("brier").number() < 0.7 * scores.at("base_rate").at("brier").number());
  CHECK(scores.at("quadratic_logistic").at("brier").number() < 0.7 * scores.at("base_rate").at("brier").number());
  const std::string best_of_all = evaluation.scores.best_by(&learning::ForecastScores::brier);
  for (const auto& [who, of] : evaluation.scores.of)
    CHECK(scores.at(best_of_all).at("brier").number() <= of.brier.value);
  CHECK(to_json(read_scores(Json::parse(scores.dump(), "scores"))).dump() == scores.dump());
  CHECK(scores_text(evaluation.scores).find("best by Brier score: " + best_of_all) != std::string::npos);
  const Json& rest = scores.at("model_minus_best");
  for (const char* score : {"brier", "log_loss_nat"}) {
    const Json& best = rest.at(score);
    CHECK(best.at("value").number() ==
          Approx(model.at(score).number() - scores.at(best.at("baseline").string()).at(score).number()));
    for (const char* baseline : kBaselines)
      CHECK(scores.at(best.at("baseline").string()).at(score).number() <= scores.at(baseline).at(score).number());
  }

  // Nothing hidden: the scores on the same rows; all hidden: every forecaster knows the base rate at most.
  const auto& curve = report.at("missing").items();
  REQUIRE(curve.size() == 8);  // seven variables vary
  const double hidden_all = curve.back().at("brier").at("model").number(),
               base = curve.back().at("brier").at("base_rate").number();
  CHECK(curve.front().at("brier").at("model").number() < 0.7 * base);
  CHECK(hidden_all == Approx(base).margin(0.03));
  for (std::size_t k = 0; k + 1 < curve.size(); ++k)
    CHECK(curve[k].at("brier").at("model").number() < curve[k + 1].at("brier").at("model").number() + 0.02);
  // Seven variables, two of which decide: summing unknown ones out beats taking their mean in every trial's stead.
  for (const char* baseline : {"logistic_regression", "neural_network"}) {
    const Json& two = curve[2].at("difference").at(baseline).at("brier");
    CHECK(two.at("value").number() ==
          Approx(curve[2].at("brier").at("model").number() - curve[2].at("brier").at(baseline).number()));
    CHECK(two.at("low").number() < two.at("value").number());
  }
  std::printf("%s%s", missing_text(evaluation.missing).c_str(), checks_text(evaluation.checks).c_str());

  const auto files = write_evaluation(scratch() / "scores", report, evaluation.scores, evaluation.missing);
  CHECK(Json::read(files[0]).dump() == report.dump());
  const std::string csv = read_file(files[1]);
  CHECK(std::count(csv.begin(), csv.end(), '\n') == 1 + 6 * 10);
  for (const auto& file : files) CHECK(fs::file_size(file) > 100);
  refused([] { evaluate_model(model_file(), model_dataset()); }, "trained on");
}

TEST_CASE("an evaluation says what holds and what does not, with the limits") {
  Evaluation evaluation;
  learning::ForecastScores model;
  model.calibration_error = 0.05, model.floor.calibration_mean = 0.031;
  evaluation.scores.of.emplace_back("model", model);
  evaluation.scores.brier = {"neural_network", {0.01, -0.02, 0.03}};
  evaluation.scores.log_loss = {"logistic_regression", {0.02, 0.01, 0.03}};
  const auto scored = [](const char* name, const learning::Interval& difference) {
    return MissingPoint::Scored{name, 0, 0, difference, {}};
  };
  evaluation.missing = {
      {.hidden = 2,
       .scored = {scored("model", {}), scored("logistic_regression", {-0.02, -0.03, -0.01}),
                  scored("neural_network", {0.001, -0.01, 0.01}), scored("base_rate", {-0.1, -0.2, 0})}}};
  std::string holds;
  for (const Criterion& check : evaluation_checks(evaluation)) holds += check.holds ? "y" : "n";
  CHECK(holds == "ynyyn");
  evaluation.scores.of.front().second.calibration_error = 0.052;
  const std::vector<Criterion> worse = evaluation_checks(evaluation);
  CHECK_FALSE(worse[2].holds);
  const std::string text = checks_text(worse);
  CHECK(text.find("misses log loss minus that of logistic_regression") != std::string::npos);
  CHECK(text.find("-0.0200 [-0.0300, -0.0100]") != std::string::npos);
}

TEST_CASE("a table of points gets the answers of single points; bad cells are refused by line and name") {
  const Predictor predictor = Predictor::read(model_file());
  const fs::path in = scratch() / "points.csv", out = scratch() / "answers.csv";
  write_file_atomically(in, "friction_angle,slope_along\n33,12\n,20\r\n30,\n");
  CHECK(infer_csv(predictor, in, out) == 3);
  std::istringstream lines(read_file(out));
  std::string text;
  std::getline(lines, text);
  CHECK(text.rfind("friction_angle,slope_along,p_go,", 0) == 0);
  for (const auto& [angle, slope] :
       {std::pair(33.0, 12.0), std::pair(double(NAN), 20.0), std::pair(30.0, double(NAN))}) {
    std::getline(lines, text);
    std::vector<double> x(contract().variables.size(), NAN);
    x[0] = slope;
    x[2] = angle;
    const std::size_t cell = text.find(',', text.find(',') + 1) + 1;
    CHECK(std::stod(text.substr(cell)) == Approx(predictor.p_go(x)).margin(1e-6));
  }
  const auto bad = [&](const std::string& content, const std::string& said) {
    write_file_atomically(in, content);
    refused([&] { infer_csv(predictor, in, out); }, said);
  };
  bad("slope_alon\n1\n", "slope_along");
  bad("slope_along\nsteep\n", "line 2: slope_along: \"steep\"");
  bad("slope_along\n1,2\n", "line 2");
  bad("slope_along\n400\n", "outside");
  bad("slope_along,slope_along\n1,2\n", "twice");
}

TEST_CASE("a conversation keeps what was said, forgets on demand, explains mistakes, and tells the unknown variables") {
  const Predictor predictor = Predictor::read(model_file());
  std::istringstream in(
      "slope_along=12 friction_angle=33\nslope_alog=3\nfriction_angle=?\noutcome=no_go/traction\nquit\n");
  std::ostringstream out;
  converse(predictor, in, out);
  std::vector<double> x(contract().variables.size(), NAN);
  x[0] = 12;
  char said[60];
  std::snprintf(said, sizeof said, "P(go or slow-go)         %.4f", predictor.p_go(x));
  CHECK(out.str().find(said) != std::string::npos);
  CHECK(out.str().find("slope_along") != std::string::npos);
  CHECK(out.str().find("given that it ended no_go/traction") != std::string::npos);

  // No-go trials lie on steeper ground than go trials; the truth is logistic in the slope.
  Question question{std::vector<double>(contract().variables.size(), NAN), outcome_named("go"), true};
  const double easy =
      to_json(answer_question(predictor, question)).at("reconstruction").at("slope_along").at("mean").number();
  question.outcome = outcome_named("no_go/slid_back");
  const Json steep = to_json(answer_question(predictor, question)).at("reconstruction").at("slope_along");
  std::printf("mean slope of go %.1f, of slid back %.1f degrees\n", easy, steep.at("mean").number());
  CHECK(steep.at("mean").number() > easy + 5);
  CHECK(steep.at("deviation").number() > 1);
  refused([] { outcome_named("maybe"); }, "slow_go");
}
