// From trials to a model file and back: training, prediction, and what is refused.
#include <omp.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "base/error.h"
#include "base/file.h"
#include "base/hash.h"
#include "learning/score/calibration.h"
#include "pipeline/dataset/dataset.h"
#include "pipeline/learn/capacity.h"
#include "pipeline/learn/evaluate_model.h"
#include "pipeline/learn/evaluation_checks.h"
#include "pipeline/learn/infer.h"
#include "pipeline/learn/predictor.h"
#include "pipeline/learn/train_model.h"
#include "tests/pipeline/synthetic_trials.h"
#include "tests/support/catch.h"
#include "tests/support/refused.h"
#include "tests/support/temporary_folder.h"

using namespace gonogo;
using namespace gonogo::pipeline;
namespace fs = std::filesystem;

namespace {

const TemporaryFolder kScratch;
const fs::path kFolder = kScratch.path();

fs::path dataset_file(const std::string& name, std::size_t trials, std::uint64_t seed) {
  const fs::path path = kFolder / name;
  write_dataset(path, {synthetic_trials(trials, seed), {}});
  return path;
}

/// The model that most tests ask, trained once.
const fs::path& model_file() {
  static const fs::path path = [] {
    const fs::path file = kFolder / "model.h5";
    train_model(
        {.dataset = dataset_file("dataset.h5", 120, 1), .model = file, .seed = 3, .learning = {}, .design = {}});
    return file;
  }();
  return path;
}

std::vector<double> middle_point() { return {12, 0, 33, 10, 0.5, 1500, 0.65, 0.3, 2}; }

}  // namespace

TEST_CASE("failed trials are left out and counted, and their rate is modelled apart") {
  const auto records = synthetic_trials(300, 4);
  std::size_t failed = 0;
  for (const TrialRecord& record : records) failed += record.verdict == Verdict::unknown;
  REQUIRE(failed > 2);
  const TrainingData data = make_training_data(records, {});
  CHECK(data.failed == failed);
  CHECK(data.table.row_count() == 300 - failed);
  const learning::Model model = learning::read_model(model_file());
  const Json& counts = model.provenance.at("counts");
  CHECK(counts.at("trials").integer() == 120);
  CHECK(counts.at("trained_on").integer() + counts.at("left_out_unknown").integer() == 120);
  CHECK(model.training_outcomes.size() == std::size_t(counts.at("trained_on").integer()));
  const Json& failures = model.provenance.at("failures");
  CHECK(failures.at("rate").number() == Approx(counts.at("left_out_unknown").number() / 120));
  CHECK(failures.at("rate_low").number() < failures.at("rate").number());
  CHECK(failures.at("modelled_rate_highest").number() >= failures.at("rate").number());
}

TEST_CASE("rows are weighted by prior over proposal, replicates share a group, fixed variables get no units") {
  auto records = synthetic_trials(20, 4);
  for (std::size_t n = 0; n < 20; ++n) records[n].verdict = Verdict::go, records[n].reason = Reason::none;
  records[0].point.proposal_density = 4;
  const TrainingData data = make_training_data(records, {});
  CHECK(data.table.weight[0] == Approx(data.table.weight[1] / 4));
  double sum = 0;
  for (double w : data.table.weight) sum += w;
  CHECK(sum == Approx(20));
  CHECK(data.table.group[9] == data.table.group[8]);
  CHECK(data.table.group[7] != data.table.group[8]);
  const LearningSettings defaults;
  const learning::VisibleLayout layout = make_layout(data, defaults);
  CHECK(layout.encoders()[layout.variable_index("bed_depth")].unit_count() == 0);
  CHECK(layout.encoders()[layout.variable_index("slope_along")].unit_count() == 10);
  CHECK(layout.outcome_count() == contract().outcomes.size());

  const Config design = Config::parse(R"({"ranges": {"slope_along": [-5, 40]}, "points": 9})", "study");
  CHECK(make_training_data(records, design).lower[0] == -5);
  CHECK(make_training_data(records, design).upper[0] == 40);
}

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
  const auto point = std::span(points).subspan(9 * 70, 9);
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

TEST_CASE("same dataset, seed and settings give the same model bytes with one and two threads") {
  const fs::path dataset = dataset_file("small.h5", 50, 2);
  const Config learning = Config::parse(R"({"epochs": 30, "folds": 3})", "study");
  const int threads = omp_get_max_threads();
  std::vector<std::string> hashes;
  for (int count : {1, 2}) {
    omp_set_num_threads(count);
    const fs::path file = kFolder / ("model" + std::to_string(count) + ".h5");
    train_model({.dataset = dataset, .model = file, .seed = 5, .learning = learning, .design = {}});
    hashes.push_back(file_hash(file));
  }
  omp_set_num_threads(threads);
  CHECK(hashes[0] == hashes[1]);
}

TEST_CASE("trials that are held out by count are those that evaluation scores") {
  const fs::path dataset = dataset_file("held_out.h5", 120, 8), file = kFolder / "held_out_model.h5";
  const Config learning = Config::parse(R"({"epochs": 20, "folds": 2})", "study");
  TrainRequest request{
      .dataset = dataset, .model = file, .seed = 5, .learning = learning, .design = {}, .hold_out = 40};
  const Json report = train_model(request);
  const std::int64_t held = report.at("counts").at("held_out").integer();
  CHECK(held >= 40);
  CHECK(held < 50);  // whole groups of replicates
  const Json scores = evaluate_model(file, dataset);
  CHECK(scores.at("trials").integer() == held);
  CHECK(scores.at("left_out_trained_on").integer() == report.at("counts").at("trained_on").integer());
  request.hold_out = 1000;
  refused([&] { train_model(request); }, "held out");
}

TEST_CASE("evaluation scores unseen trials only, beside the baselines") {
  const Json report = evaluate_model(model_file(), dataset_file("fresh.h5", 400, 55));
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
  const Json& rest = scores.at("model_minus_best");
  for (const char* score : {"brier", "log_loss_nat"}) {
    const Json& best = rest.at(score);
    CHECK(best.at("value").number() ==
          Approx(model.at(score).number() - scores.at(best.at("baseline").string()).at(score).number()));
    for (const char* baseline : {"logistic_regression", "neural_network", "base_rate"})
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
  std::printf("%s%s", missing_text(report.at("missing")).c_str(), checks_text(report.at("checks")).c_str());

  const auto files = write_evaluation(kFolder / "scores", report, scores);
  CHECK(Json::read(files[0]).dump() == report.dump());
  const std::string csv = read_file(files[1]);
  CHECK(std::count(csv.begin(), csv.end(), '\n') == 1 + 4 * 10);
  for (const auto& file : files) CHECK(fs::file_size(file) > 100);
  refused([] { evaluate_model(model_file(), kFolder / "dataset.h5"); }, "trained on");
}

TEST_CASE("an evaluation says what holds and what does not, with the limits") {
  const auto interval = [](double low, double value, double high) {
    Json json;
    json["low"] = low, json["value"] = value, json["high"] = high;
    return json;
  };
  Json report, scores, rest, point, difference;
  rest["brier"] = interval(-0.02, 0.01, 0.03), rest["log_loss_nat"] = interval(0.01, 0.02, 0.03);
  rest["brier"]["baseline"] = "neural_network", rest["log_loss_nat"]["baseline"] = "logistic_regression";
  scores["model"]["calibration_error"] = 0.05, scores["model"]["floor_calibration_error_mean"] = 0.031;
  scores["model_minus_best"] = rest;
  report["scores"] = scores;
  difference["logistic_regression"]["brier"] = interval(-0.03, -0.02, -0.01);
  difference["neural_network"]["brier"] = interval(-0.01, 0.001, 0.01);
  difference["base_rate"]["brier"] = interval(-0.2, -0.1, 0);
  point["hidden"] = 2, point["difference"] = difference;
  report["missing"] = Json::array();
  report["missing"].push_back(point);
  std::string holds;
  const Json checks = evaluation_checks(report);
  for (const Json& check : checks.items()) holds += check.at("holds").boolean() ? "y" : "n";
  CHECK(holds == "ynyyn");
  report["scores"]["model"]["calibration_error"] = 0.052;
  const Json worse = evaluation_checks(report);
  CHECK_FALSE(worse.items()[2].at("holds").boolean());
  const std::string text = checks_text(worse);
  CHECK(text.find("misses log loss minus that of logistic_regression") != std::string::npos);
  CHECK(text.find("-0.0200 [-0.0300, -0.0100]") != std::string::npos);
}

TEST_CASE("a table of points gets the answers of single points; bad cells are refused by line and name") {
  const Predictor predictor = Predictor::read(model_file());
  const fs::path in = kFolder / "points.csv", out = kFolder / "answers.csv";
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
    x[0] = slope, x[2] = angle;
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
  const double easy = answer_question(predictor, question).at("reconstruction").at("slope_along").at("mean").number();
  question.outcome = outcome_named("no_go/slid_back");
  const Json steep = answer_question(predictor, question).at("reconstruction").at("slope_along");
  std::printf("mean slope of go %.1f, of slid back %.1f degrees\n", easy, steep.at("mean").number());
  CHECK(steep.at("mean").number() > easy + 5);
  CHECK(steep.at("deviation").number() > 1);
  refused([] { outcome_named("maybe"); }, "slow_go");
}

TEST_CASE("calibration by a power is learned on held-out folds, kept in the model and applied everywhere") {
  const fs::path dataset = dataset_file("calibrate.h5", 120, 2), file = kFolder / "calibrated.h5";
  const Config learning = Config::parse(R"({"epochs": 60, "folds": 3, "calibrate": true})", "study");
  const Json report = train_model({.dataset = dataset, .model = file, .seed = 5, .learning = learning, .design = {}});
  const double power = report.at("calibration_power").number();
  CHECK(power != 1);
  const Predictor predictor = Predictor::read(file);
  CHECK(predictor.model().calibration_power == power);
  learning::Model plain = predictor.model();
  plain.calibration_power = 1;
  auto expected = Predictor(plain).outcome_probabilities(middle_point());
  learning::sharpen(expected, power);
  const auto found = predictor.outcome_probabilities(middle_point());
  for (std::size_t y = 0; y < found.size(); ++y) CHECK(found[y] == Approx(expected[y]).epsilon(1e-12));
  std::vector<double> batch(found.size());
  predictor.outcome_probabilities(middle_point(), batch);
  CHECK(batch == found);
}

TEST_CASE("a command that fails while training is stood in for, and the model says so") {
  const fs::path dataset = dataset_file("stand_in.h5", 50, 2), file = kFolder / "stood_in.h5";
  const Config learning = Config::parse(
      R"({"epochs": 10, "folds": 2, "sampler": "command", "command": ["false"], "stand_in": "block_gibbs"})", "study");
  const Json report = train_model({.dataset = dataset, .model = file, .seed = 5, .learning = learning, .design = {}});
  CHECK(report.at("stand_in").boolean());
  CHECK(report.at("sampler").string() == "block_gibbs");
  CHECK(report.at("sampler_wanted").string() == "command");
  CHECK(learning::read_model(file).provenance.at("stand_in_reason").string() == report.at("stand_in_reason").string());
  CHECK(report_text(report).find("block_gibbs stood in") != std::string::npos);
}

TEST_CASE("a study trains through the emulated annealer, masks what dead qubits cannot couple, and says so") {
  const fs::path dataset = dataset_file("emulated.h5", 40, 2), file = kFolder / "emulated.h5model";
  const Config learning = Config::parse(
      R"({"epochs": 3, "folds": 2, "hidden": 6, "chains": 16, "sampler": "emulator",
          "emulator": {"graph": "zephyr:6", "dead_share": 0.45, "sweeps": 20, "reads": 40, "gauges": 2}})",
      "study");
  const Json report = train_model({.dataset = dataset, .model = file, .seed = 5, .learning = learning, .design = {}});
  CHECK(report.at("sampler").string() == "emulator");
  const Json& annealer = report.at("annealer");
  CHECK(annealer.at("readings").items().size() >= 1);
  const auto masked = std::size_t(annealer.at("masked_pairs").integer());
  CHECK(masked > 0);
  const learning::Model model = learning::read_model(file);
  std::size_t zero = 0;
  for (double w : model.weights.weight) zero += w == 0;
  CHECK(zero == masked);
  CHECK(report_text(report).find("pairs of units masked") != std::string::npos);
}

TEST_CASE(
    "capacity: more bits and hidden units cost more, what is coupled less costs less, and impossible graphs are said") {
  CapacityRequest request{.dataset = dataset_file("capacity.h5", 100, 3),
                          .learning = Config::parse(R"({"epochs": 40, "folds": 2})", "study"),
                          .design = {},
                          .seed = 2,
                          .bits = {2, 5},
                          .hidden = {3},
                          .connectivity = {"full", "sparse:0.5", "chimera:2"}};
  const Json report = measure_capacity(request);
  const auto& machines = report.at("machines").items();
  REQUIRE(machines.size() == 6);
  const auto whole = [&](std::size_t k, const char* key) { return machines[k].at(key).integer(); };
  for (std::size_t k : {0u, 3u}) {
    CHECK(whole(k, "couplers") == whole(k, "visible") * 3);
    CHECK(whole(k, "parameters") == whole(k, "couplers") + whole(k, "visible") + 3);
    const double loss = machines[k].at("held_out_loss_nat").number();
    CHECK(loss < std::log(double(contract().outcomes.size())) - 0.5);  // half a nat better than no knowledge at all
    CHECK(machines[k].at("gain_nat").number() == Approx(report.at("base_loss_nat").number() - loss));
    CHECK(double(whole(k + 1, "couplers")) == Approx(0.5 * double(whole(k, "couplers"))).epsilon(0.5));
    CHECK(machines[k + 2].at("impossible").string().find("lines") != std::string::npos);
  }
  CHECK(whole(3, "visible") > whole(0, "visible"));
  CHECK(capacity_text(report).find("sparse:0.5") != std::string::npos);
  request.connectivity = {"sparse:2"};
  refused([&] { measure_capacity(request); }, "share");
  request.connectivity = {"chimra:12"};
  refused([&] { measure_capacity(request); }, "chimra");
}

TEST_CASE("settings are read strictly") {
  const auto read = [](const std::string& text) { return read_learning_settings(Config::parse(text, "study.json")); };
  CHECK(read(R"({"hidden": 20, "sampler": "exact", "bins": "quantile"})").quantile_bins);
  CHECK(read(R"({"encoders": {"cohesion": {"code": "gray", "bits": 3}}})").encoders.at("cohesion").bits == 3);
  refused([&] { read(R"({"hiden": 20})"); }, "hidden");
  refused([&] { read(R"({"hidden": 0})"); }, "hidden");
  refused([&] { read(R"({"sampler": "annealer"})"); }, "block_gibbs");
  refused([&] { read(R"({"encoders": {"slope_alon": {"code": "gray", "bits": 3}}})"); }, "slope_along");
  refused([&] { read(R"({"weight_decay": -1})"); }, "weight_decay");
  refused([&] { read(R"({"negative": "tempring"})"); }, "tempering");
  refused([&] { read(R"({"negative": "tempering", "sampler": "anneal"})"); }, "persistent");
  refused([&] { read(R"({"sampler": "command"})"); }, "command");
  refused([&] { read(R"({"gpu": "yes"})"); }, "never");
  refused([&] { read(R"({"sampler": "emulator", "emulator": {"graph": "chimera:12", "deadshare": 0.1}})"); },
          "dead_share");
  CHECK(read(R"({"sampler": "emulator", "emulator": {"gauges": 7}})").emulator.gauges == 7);
  CHECK_FALSE(read(R"({"gpu": "never"})").gpu);
  CHECK_FALSE(read(R"({"unknown_inputs": "machine"})").uniform_inputs);
  refused([&] { read(R"({"unknown_inputs": "mean"})"); }, "prior");
  CHECK(to_json(read(R"({"negative": "trajectory", "optimizer": "sgd", "centred": true})")).at("negative").string() ==
        "trajectory");
}

TEST_CASE("datasets without anything to learn are refused") {
  auto records = synthetic_trials(20, 4);
  for (auto& record : records) record.verdict = Verdict::unknown, record.reason = Reason::simulation_failed;
  refused([&] { make_training_data(records, {}); }, "20");
  records[3].verdict = Verdict::go, records[3].reason = Reason::none;
  records[3].point.proposal_density = 0;
  refused([&] { make_training_data(records, {}); }, "proposal density");
}

TEST_CASE("damaged model files are refused") {
  const std::string whole = read_file(model_file());
  const fs::path damaged = kFolder / "damaged.h5";
  for (std::size_t length : {std::size_t(0), std::size_t(100), whole.size() / 2, whole.size() - 1000}) {
    write_file_atomically(damaged, whole.substr(0, length));
    CHECK_THROWS_AS(Predictor::read(damaged), InputError);
  }
  refused([] { Predictor::read(kFolder / "absent.h5"); }, "absent.h5");
  refused([] { Predictor::read(kFolder / "dataset.h5"); }, "not a model");

  const learning::Model good = learning::read_model(model_file());
  const auto written = [&](const std::function<void(learning::Model&)>& damage) {
    learning::Model model = good;
    damage(model);
    write_model(damaged, model);
    CHECK_THROWS_AS(Predictor::read(damaged), InputError);
  };
  written([](learning::Model& m) { m.weights.weight[5] = NAN; });
  written([](learning::Model& m) { m.weights.hidden_bias[0] = INFINITY; });
  written([](learning::Model& m) { m.weights.visible_bias.pop_back(); });
  written([](learning::Model& m) { m.sampled_lower.pop_back(); });
  written([](learning::Model& m) { std::swap(m.sampled_lower, m.sampled_upper); });
  written([](learning::Model& m) { m.training_outcomes[0] = 99; });
  written([](learning::Model& m) { m.training_weights[0] = 0; });
  written([](learning::Model& m) { m.training_weights.pop_back(); });
  written([](learning::Model& m) { m.input_prior[0][0] += 0.1; });
  written([](learning::Model& m) { m.input_prior.pop_back(); });
  written([](learning::Model& m) {
    auto outcomes = m.layout.outcomes();
    outcomes[2] = "no_go/other";
    m.layout = learning::VisibleLayout(m.layout.encoders(), outcomes);
  });
  write_model(damaged, good);
  CHECK(read_file(damaged) == whole);
}
