// From trials to a model file: training, settings, and what is refused.
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/error.h"
#include "base/files/file.h"
#include "learning/rbm/train.h"
#include "learning/score/score.h"
#include "pipeline/outcome/answer/infer.h"
#include "pipeline/outcome/answer/predictor.h"
#include "pipeline/outcome/evaluation/evaluate_model.h"
#include "pipeline/outcome/training/capacity.h"
#include "pipeline/outcome/training/train_model.h"
#include "tests/pipeline/outcome/trained_model.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/refused.h"

using namespace gonogo;
using namespace gonogo::campaign;
using namespace gonogo::outcome;
namespace fs = std::filesystem;

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
  TrainingData half = data, none = data;
  temper_weights(half, 0.5);
  temper_weights(none, 0);
  CHECK(half.table.weight[0] == Approx(half.table.weight[1] / 2));
  CHECK(none.table.weight == std::vector<double>(20, 1.0));
  CHECK(data.table.group[9] == data.table.group[8]);
  CHECK(data.table.group[7] != data.table.group[8]);
  const LearningSettings defaults;
  const learning::VisibleLayout layout = make_layout(data, defaults);
  CHECK(layout.encoders()[layout.variable_index("bed_depth")].unit_count() == 0);
  CHECK(layout.encoders()[layout.variable_index("slope_along")].unit_count() == 10);
  CHECK(layout.outcome_count() == contract().outcomes.size());

  const auto with = [](const char* encoders) { return read_learning_settings(Config::parse(encoders, "study.json")); };
  const auto given = with(R"({"encoders": {"cohesion": {"code": "thermometer", "edges": [1, 3, 10]}}})");
  const learning::Encoder cohesion = make_layout(data, given).encoders()[layout.variable_index("cohesion")];
  CHECK(cohesion.edges() == std::vector<double>{1, 3, 10});
  CHECK(cohesion.upper() == data.upper[layout.variable_index("cohesion")]);
  CHECK(to_json(given).at("encoders").at("cohesion").at("edges").items().size() == 3);
  const auto outside = with(R"({"encoders": {"cohesion": {"code": "thermometer", "edges": [1, 3, 100]}}})");
  refused([&] { make_layout(data, outside); }, "encoder of cohesion: edge 100");
  refused([&] { with(R"({"encoders": {"cohesion": {"code": "gray", "bits": 3, "edges": [1]}}})"); }, "edges");

  const Config design = Config::parse(R"({"ranges": {"slope_along": [-5, 40]}, "points": 9})", "study");
  CHECK(make_training_data(records, design).lower[0] == -5);
  CHECK(make_training_data(records, design).upper[0] == 40);
}

TEST_CASE("same dataset, seed and settings give the same model bytes with one and two threads") {
  const fs::path dataset = dataset_file("small.h5", 50, 2);
  const Config learning = Config::parse(R"({"epochs": 30, "folds": 3})", "study");
  const int threads = omp_get_max_threads();
  std::vector<std::string> hashes;
  for (int count : {1, 2}) {
    omp_set_num_threads(count);
    const fs::path file = scratch() / ("model" + std::to_string(count) + ".h5");
    train_model({.dataset = dataset, .model = file, .seed = 5, .learning = learning, .design = {}});
    hashes.push_back(file_hash(file));
  }
  omp_set_num_threads(threads);
  CHECK(hashes[0] == hashes[1]);
}

TEST_CASE("a model keeps the gravity of its trials, and one of the Earth has no key for it") {
  const Config learning = Config::parse(R"({"epochs": 5, "folds": 2})", "study");
  const auto gravity_in = [&](const std::string& study) {
    const fs::path dataset = scratch() / "gravity.h5", file = scratch() / "gravity_model.h5";
    Provenance provenance;
    provenance.study = study;
    write_dataset(dataset, {synthetic_trials(40, 3), provenance});
    train_model({.dataset = dataset, .model = file, .seed = 5, .learning = learning, .design = {}});
    const Predictor predictor = Predictor::read(file);
    CHECK((predictor.model().provenance.find(kGravityKey) == nullptr) == study.empty());
    const Answer answer = answer_question(predictor, {middle_point(), std::nullopt, false});
    CHECK(to_json(answer).at("gravity_m_per_s2").number() == gravity_of(predictor.model()));
    CHECK(contains(answer_text(answer), "gravity of the trials " + (study.empty() ? std::string("9.81") : "1.62")));
    return gravity_of(predictor.model());
  };
  CHECK(gravity_in(R"({"study": "moon", "gravity": 1.62})") == 1.62);
  CHECK(gravity_in("") == kGravity);
  refused([&] { gravity_in(R"({"study": "moon", "gravity": -1})"); }, "gravity: value -1 is outside");
}

TEST_CASE("trials that are held out by count are those that evaluation scores") {
  const fs::path dataset = dataset_file("held_out.h5", 120, 8), file = scratch() / "held_out_model.h5";
  const Config learning = Config::parse(R"({"epochs": 20, "folds": 2})", "study");
  TrainRequest request{
      .dataset = dataset, .model = file, .seed = 5, .learning = learning, .design = {}, .hold_out = 40};
  const TrainingReport trained = train_model(request);
  const Json report = to_json(trained);
  const std::int64_t held = report.at("counts").at("held_out").integer();
  CHECK(held >= 40);
  CHECK(held < 50);  // whole groups of replicates
  const Json scores = to_json(evaluate_model(file, dataset));
  CHECK(scores.at("trials").integer() == held);
  CHECK(scores.at("left_out_trained_on").integer() == report.at("counts").at("trained_on").integer());
  std::size_t failed = 0;
  for (const TrialRecord& record : synthetic_trials(120, 8)) failed += record.verdict == Verdict::unknown;
  const Json& failures = report.at("failures");  // held-out trials did not fail
  CHECK(failures.at("rate").number() == Approx(double(failed) / 120));
  CHECK(failures.at("rate_low").number() < double(failed) / 120);
  CHECK(failures.at("rate_high").number() > double(failed) / 120);
  CHECK(failures.at("rate_high").number() < 0.15);
  request.hold_out = 1000;
  refused([&] { train_model(request); }, "held out");
}

TEST_CASE("calibration by a power is learned on held-out folds, kept in the model and applied everywhere") {
  const fs::path dataset = dataset_file("calibrate.h5", 120, 2), file = scratch() / "calibrated.h5";
  const Config learning = Config::parse(R"({"epochs": 60, "folds": 3, "calibrate": true})", "study");
  const TrainingReport trained =
      train_model({.dataset = dataset, .model = file, .seed = 5, .learning = learning, .design = {}});
  const Json report = to_json(trained);
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
  const fs::path dataset = dataset_file("stand_in.h5", 50, 2), file = scratch() / "stood_in.h5";
  const Config learning = Config::parse(
      R"({"epochs": 10, "folds": 2, "sampler": "command", "command": ["false"], "stand_in": "block_gibbs"})", "study");
  const TrainingReport trained =
      train_model({.dataset = dataset, .model = file, .seed = 5, .learning = learning, .design = {}});
  const Json report = to_json(trained);
  CHECK(report.at("stand_in").boolean());
  CHECK(report.at("sampler").string() == "block_gibbs");
  CHECK(report.at("sampler_wanted").string() == "command");
  CHECK(learning::read_model(file).provenance.at("stand_in_reason").string() == report.at("stand_in_reason").string());
  CHECK(report_text(trained).find("block_gibbs stood in") != std::string::npos);
}

TEST_CASE("a study trains through the emulated annealer, masks what dead qubits cannot couple, and says so") {
  const fs::path dataset = dataset_file("emulated.h5", 40, 2), file = scratch() / "emulated.h5model";
  const Config learning = Config::parse(
      R"({"epochs": 3, "folds": 2, "hidden": 6, "chains": 16, "sampler": "emulator",
          "emulator": {"graph": "zephyr:6", "dead_share": 0.45, "sweeps": 20, "reads": 40, "gauges": 2}})",
      "study");
  const TrainingReport trained =
      train_model({.dataset = dataset, .model = file, .seed = 5, .learning = learning, .design = {}});
  const Json report = to_json(trained);
  CHECK(report.at("sampler").string() == "emulator");
  const Json& annealer = report.at("annealer");
  CHECK(annealer.at("readings").items().size() >= 1);
  const auto masked = std::size_t(annealer.at("masked_pairs").integer());
  CHECK(masked > 0);
  const learning::Model model = learning::read_model(file);
  std::size_t zero = 0;
  for (double w : model.weights.weight) zero += w == 0;
  CHECK(zero == masked);
  CHECK(report_text(trained).find("pairs of units masked") != std::string::npos);
  CHECK(report_text(read_report(model.provenance)) == report_text(trained));
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
  const Capacity capacity = measure_capacity(request);
  const Json report = to_json(capacity);
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
  CHECK(capacity_text(capacity).find("sparse:0.5") != std::string::npos);
  // 100 trials in 6 bins of each of seven variables: each bin has some, and most of the pairs.
  CHECK(whole(3, "fewest_in_a_bin") >= 5);
  CHECK(whole(3, "fewest_in_a_bin") < 100 / 6);
  CHECK(machines[3].at("empty_pairs_of_bins").number() > machines[0].at("empty_pairs_of_bins").number());
  CHECK(machines[3].at("empty_pairs_of_bins").number() < 0.3);

  request.bits = {2}, request.connectivity = {"full"}, request.variable_bits = {0, 4};
  const Capacity by_variable = measure_capacity(request);
  const Json own = to_json(by_variable);
  const auto& each = own.at("machines").items();
  REQUIRE(each.size() == 1 + 7 * 2);  // seven variables vary
  const double all = each[0].at("held_out_loss_nat").number();
  CHECK(each[1].at("variable").string() == "slope_along");
  CHECK(each[1].at("visible").integer() == each[0].at("visible").integer() - 2);
  CHECK(each[2].at("visible").integer() == each[0].at("visible").integer() + 2);
  CHECK(each[1].at("held_out_loss_nat").number() > all + 0.03);
  for (std::size_t k = 3; k < each.size(); k += 2) {  // one of the others left out costs less: the slope decides
    CHECK(each[k].at("bits").integer() == 0);
    CHECK(each[k].at("held_out_loss_nat").number() < each[1].at("held_out_loss_nat").number() - 0.01);
  }
  CHECK(capacity_text(by_variable).find("one variable with other bits") != std::string::npos);
  request.variable_bits = {};
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
  refused([&] { read(R"({"gradients": "gpu"})"); }, "cuda");
  const Config on_gpu = Config::parse(R"({"gradients": "cuda"})", "study.json");
  if (learning::gradients_on_gpu())
    CHECK(trainable_settings(on_gpu).training.gradients == learning::GradientDevice::cuda);
  else
    refused([&] { trainable_settings(on_gpu); }, "LibTorch sees no GPU");
  CHECK_FALSE(read(R"({"unknown_inputs": "machine"})").uniform_inputs);
  refused([&] { read(R"({"unknown_inputs": "mean"})"); }, "prior");
  CHECK(to_json(read(R"({"negative": "trajectory", "optimizer": "sgd", "centred": true})")).at("negative").string() ==
        "trajectory");
}

TEST_CASE("datasets without anything to learn are refused") {
  auto records = synthetic_trials(20, 4);
  for (auto& record : records) {
    record.verdict = Verdict::unknown;
    record.reason = Reason::simulation_failed;
  }
  refused([&] { make_training_data(records, {}); }, "20");
  records[3].verdict = Verdict::go;
  records[3].reason = Reason::none;
  records[3].point.proposal_density = 0;
  refused([&] { make_training_data(records, {}); }, "proposal density");
}

TEST_CASE("damaged model files are refused") {
  const std::string whole = read_file(model_file());
  const fs::path damaged = scratch() / "damaged.h5";
  for (std::size_t length : {std::size_t(0), std::size_t(100), whole.size() / 2, whole.size() - 1000}) {
    write_file_atomically(damaged, whole.substr(0, length));
    CHECK_THROWS_AS(Predictor::read(damaged), InputError);
  }
  refused([] { Predictor::read(scratch() / "absent.h5"); }, "absent.h5");
  refused([] { Predictor::read(model_dataset()); }, "not a model");

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
