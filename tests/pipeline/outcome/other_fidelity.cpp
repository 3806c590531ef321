// Trials of several fidelities: which is the finest, how they are joined, and what few fine trials gain by many coarse.
#include "pipeline/outcome/training/teacher.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <numeric>

#include "base/files/file.h"
#include "base/format.h"
#include "base/math/random.h"
#include "learning/model/model.h"
#include "learning/rbm/regression/gaussian_process.h"
#include "learning/score/score.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/campaign/study/contract.h"
#include "pipeline/outcome/settings.h"
#include "pipeline/outcome/training/train_model.h"
#include "tests/pipeline/outcome/trained_model.h"
#include "tests/support/catch.h"
#include "tests/support/refused.h"

using namespace gonogo;
using namespace gonogo::outcome;
namespace fs = std::filesystem;

namespace {

const fs::path kData = fs::path(GONOGO_SOURCE_DIR) / "data";
const fs::path kVehicle = kData / "hmmwv_32mm_unsolved/dataset.h5", kQuarter = kData / "quarter_wheel_32mm/dataset.h5",
               kFresh = kData / "hmmwv_32mm_fresh/dataset.h5";

/// Trials of two variables: passed below a curve, which is one of shape for all fidelities and lies `shift` higher.
learning::TrainingTable curved(std::size_t count, double shift, std::uint64_t seed) {
  learning::TrainingTable table;
  table.variable_count = 2;
  for (std::size_t n = 0; n < count; ++n) {
    const double x = 20 * random_unit(seed, 0, n) - 10, y = random_unit(seed, 1, n);
    table.variables.insert(table.variables.end(), {x, y});
    table.outcome.push_back(x < shift + 6 * std::sin(7 * y) ? 0 : 1);
    table.weight.push_back(1);
    table.group.push_back(n);
  }
  return table;
}

OtherTrials other_trials(const fs::path& own, const std::vector<fs::path>& others) {
  return read_other_trials(campaign::read_dataset(own).provenance, own.string(), others);
}

Fidelity fidelity_of(const fs::path& file) {
  return source_of(campaign::read_dataset(file).provenance, file.string()).fidelity;
}

std::vector<int> labels(const learning::TrainingTable& table) {
  std::vector<int> result;
  for (std::size_t y : table.outcome) result.push_back(y == 0);
  return result;
}

}  // namespace

TEST_CASE("few trials correct the forecast of a family, and with it say more than alone or the forecast by itself") {
  constexpr double kShift = 2;  // of the vehicle's boundary from its family's
  OtherTrials known;
  known.forecast = std::make_shared<const Forecast>(
      Forecast{.hash = "h", .about = "family", .trials = 9, .p_go = [](const std::vector<double>& points) {
                 std::vector<double> p;
                 for (std::size_t n = 0; n < points.size(); n += 2)
                   p.push_back(1 / (1 + std::exp(2 * (points[n] - 6 * std::sin(7 * points[n + 1])))));
                 return p;
               }});
  const learning::TrainingTable fresh = curved(1000, kShift, 77);
  const std::vector<int> truth = labels(fresh);
  const auto error = [&](const std::vector<double>& p) {
    double sum = 0;
    for (std::size_t n = 0; n < truth.size(); ++n) sum += std::pow(p[n] - truth[n], 2);
    return sum / double(truth.size());
  };
  double alone = 0, together = 0;
  for (const std::uint64_t seed : {1, 2, 3}) {
    learning::TrainingTable few = curved(48, kShift, seed);
    for (std::size_t& y : few.outcome)
      if (y == 1) y = campaign::contract().outcome_index(campaign::Verdict::no_go, campaign::Reason::traction);
    alone += error(Teacher(few, {})(fresh.variables)) / 3;
    together += error(Teacher(few, known)(fresh.variables)) / 3;
  }
  const double family = error(known.forecast->p_go(fresh.variables));
  UNSCOPED_INFO("alone " << alone << ", family " << family << ", together " << together);
  CHECK(together < 0.7 * alone);
  CHECK(together < 0.7 * family);
}

TEST_CASE("the shipped trials of the whole vehicle are finer than those of a quarter of it") {
  const Fidelity whole = fidelity_of(kVehicle), quarter = fidelity_of(kQuarter);
  CHECK(whole.text() ==
        "whole vehicle, compliant tyres, 7.9 grains across a wheel, which roll freely on it, "
        "contacts left unsolved");
  CHECK(quarter.text() ==
        "quarter of a vehicle, rigid tyres, 7.9 grains across a wheel, which roll freely on it, "
        "contacts left unsolved");
  CHECK(whole.grains_per_tyre == Approx(0.254 / 0.032));
  CHECK(whole.is_finer_than(quarter));
  CHECK_FALSE(quarter.is_finer_than(whole));
  CHECK_FALSE(whole.is_finer_than(whole));
  Fidelity coarse = quarter;
  coarse.grains_per_tyre = 2.8;
  CHECK(quarter.is_finer_than(coarse));
  Fidelity resisting = coarse, half = coarse, twice = coarse;
  resisting.wheel_rolling = 1;
  half.wheel_rolling = 0.5;
  twice.wheel_rolling = 2;
  CHECK(resisting.is_finer_than(quarter));
  CHECK(resisting.is_finer_than(half));
  CHECK(resisting.is_finer_than(twice));
  CHECK(resisting.inputs() == std::vector<double>{0, 0, std::log2(2.8), 1, 0});
  CHECK(resisting.text().find("which resist rolling on it, ") != std::string::npos);
  CHECK(half.text().find("which resist rolling on it 0.5-fold") != std::string::npos);
  CHECK(finest_first({kQuarter, kVehicle}) == std::vector<fs::path>{kVehicle, kQuarter});
}

TEST_CASE("contacts are solved where they give, the solver stops at a tolerance, or a step has many updates") {
  const Fidelity today = fidelity_of(kFresh), older = fidelity_of(kVehicle);
  CHECK(today.text().ends_with("which resist rolling on it, contacts solved"));
  CHECK(today.is_finer_than(older));
  CHECK(today.is_finer_than(fidelity_of(kData / "hmmwv_32mm_unsolved/rolling.h5")));
  CHECK(finest_first({kVehicle, kFresh}) == std::vector<fs::path>{kFresh, kVehicle});

  const auto with = [](const char* numerics) {
    campaign::Provenance p = campaign::read_dataset(kFresh).provenance;
    p.study.insert(p.study.find('{', p.study.find("\"trial\"")) + 1, line("\"numerics\": {%s}, ", numerics));
    return source_of(p, "fresh").fidelity.has_solved_contacts;
  };
  CHECK_FALSE(with(R"("give": 0)"));
  CHECK_FALSE(with(R"("give": 0, "substeps": 49, "iterations": 2)"));
  CHECK(with(R"("give": 0, "substeps": 10, "iterations": 20)"));
  CHECK(with(R"("give": 0, "tolerance_m_per_s": 0.005)"));
  CHECK(with(R"("give": 0, "contact": "hertz")"));
}

TEST_CASE("other trials follow the own ones with their fidelity as inputs, and replicates stay together") {
  const OtherTrials others = other_trials(kVehicle, {kQuarter});
  const std::size_t variables = campaign::contract().variables.size();
  const TrainingData own = make_training_data(campaign::read_dataset(kVehicle).records, {});
  const learning::TrainingTable joined = others.joined(own.table);
  const std::size_t first = own.table.row_count();
  REQUIRE(joined.row_count() == first + others.table.row_count());
  REQUIRE(joined.variable_count == variables + 5);
  for (std::size_t v = 0; v < variables; ++v) CHECK(joined.row(5)[v] == own.table.row(5)[v]);
  CHECK(joined.row(5)[variables] == 1);
  CHECK(joined.row(first)[variables] == 0);
  CHECK(joined.row(first)[variables + 2] == Approx(std::log2(0.254 / 0.032)));
  for (std::size_t n = 0; n < 40; ++n)
    for (std::size_t m = n; m < 40; ++m)
      CHECK((joined.group[n] == joined.group[m]) == (own.table.group[n] == own.table.group[m]));
  const std::vector<double> points = others.at_own({1, 2, 3, 4}, 2);
  CHECK(points == std::vector<double>{1, 2, 1, 1, others.own[2], 0, 0, 3, 4, 1, 1, others.own[2], 0, 0});
  CHECK(other_trials(kVehicle, {}).joined(own.table).variables == own.table.variables);
}

TEST_CASE("a process that is judged at some points does not know other trials at the same points") {
  const fs::path rolling =
      kData / "hmmwv_32mm_unsolved/rolling.h5";  // the first points of kVehicle, at another fidelity
  const OtherTrials others = other_trials(rolling, {kVehicle});
  const TrainingData own = make_training_data(campaign::read_dataset(rolling).records, {});
  const learning::TrainingTable first = own.table.subset({0, 1, 2, 3, 4});
  const OtherTrials away = others.away_from(first);
  CHECK(away.own == others.own);
  CHECK(away.table.variable_count == others.table.variable_count);
  std::size_t same = 0;
  for (std::size_t n = 0; n < others.table.row_count(); ++n)
    for (std::size_t k = 0; k < 5; ++k)
      same += std::equal(first.row(k).begin(), first.row(k).end(), others.table.row(n).begin());
  CHECK(same >= 5);  // replicates, too
  CHECK(away.table.row_count() == others.table.row_count() - same);
  CHECK(others.away_from(own.table.subset({})).table.row_count() == others.table.row_count());
}

TEST_CASE("a process does not know other trials near its points either, whose study samples a little wider") {
  // The friction angles of the older study begin at 14 degrees for 15, so each of its points lies within a degree.
  const fs::path own_file = kData / "hmmwv_32mm/dataset.h5";
  const OtherTrials others = other_trials(own_file, {kVehicle});
  const TrainingData own = make_training_data(campaign::read_dataset(own_file).records, {});
  const learning::TrainingTable first = own.table.subset({0, 1, 2, 3, 4});
  const std::size_t left_out = others.table.row_count() - others.away_from(first).table.row_count();
  CHECK(left_out >= 5);
  CHECK(left_out < 15);  // and their replicates, not their neighbours
}

TEST_CASE("trials of the own fidelity teach as own ones do") {
  const fs::path first = scratch() / "first.h5", second = scratch() / "second.h5";
  campaign::Dataset half = campaign::read_dataset(kFresh);
  const std::vector<campaign::TrialRecord> all = half.records;
  half.records.assign(all.begin(), all.begin() + 150);
  campaign::write_dataset(first, half);
  half.records.assign(all.begin() + 150, all.begin() + 300);
  campaign::write_dataset(second, half);
  const auto rows = [](const fs::path& file) {
    return make_training_data(campaign::read_dataset(file).records, {}).table;
  };
  const OtherTrials others = other_trials(first, {second});
  CHECK(finest_first({second, first}) == std::vector<fs::path>{second, first});
  half.records.assign(all.begin(), all.begin() + 300);
  const std::vector<double> points = make_training_data({all.begin() + 300, all.end()}, {}).table.variables;
  const std::vector<double> apart = Teacher(rows(first), others)(points),
                            alone = Teacher(make_training_data(half.records, {}).table, {})(points);
  double most = 0;
  for (std::size_t n = 0; n < apart.size(); ++n) most = std::max(most, std::abs(apart[n] - alone[n]));
  CHECK(most < 0.02);
}

TEST_CASE("a dataset that is given twice is refused, and one that does not tell its fidelity") {
  refused([] { other_trials(kVehicle, {kQuarter, kQuarter}); }, "is given twice; name each dataset once");
  refused([] { other_trials(kVehicle, {kVehicle}); }, "is given twice; name each dataset once");
  refused([] { other_trials(kVehicle, {kData / "viper_32mm/dataset.h5"}); }, "gravity");
  const fs::path mute = dataset_file("mute.h5", 30, 2);
  refused([&] { finest_first({kVehicle, mute}); }, "does not hold its vehicle");
}

TEST_CASE("trials of another vehicle are refused, those of a quarter of the same one are not") {
  campaign::Provenance other = campaign::read_dataset(kQuarter).provenance;
  CHECK_NOTHROW(read_other_trials(other, "quarter", {kVehicle}));
  for (auto& [name, text] : other.files)
    if (name == "vehicle") text.replace(text.find("hmmwv_quarter"), 13, "truck_quarter");
  refused([&] { read_other_trials(other, "truck", {kVehicle}); }, "another vehicle needs a model of its own");
}

TEST_CASE("the rolling friction of grains on the wheels tells two fidelities apart") {
  campaign::Provenance other = campaign::read_dataset(kQuarter).provenance;
  const auto with_rolling = [&](const std::string& value) {
    campaign::Provenance p = other;
    const auto at = p.study.find("\"trial\"");
    p.study.insert(p.study.find('{', at) + 1, "\"wheel_rolling\": " + value + ", ");
    return p;
  };
  CHECK(campaign::settings_of(other, "quarter").wheel_rolling == 0);
  CHECK(campaign::settings_of(with_rolling("0.5"), "quarter").wheel_rolling == 0.5);
  CHECK(source_of(with_rolling("0"), "quarter").fidelity == fidelity_of(kQuarter));
  CHECK_FALSE(source_of(with_rolling("1"), "quarter").fidelity == fidelity_of(kQuarter));
  refused([&] { campaign::settings_of(with_rolling("-1"), "quarter"); }, "wheel_rolling");
}

TEST_CASE("a study names the trials that it learns too, by shipped name or by file") {
  const auto named = [](const std::string& list) {
    return named_trials(Config::parse(R"({"with": )" + list + "}", (kData / "study.json").string()));
  };
  CHECK(named_trials(std::nullopt).empty());
  const auto files = named(R"(["hmmwv_32mm_unsolved", "quarter_wheel_32mm/dataset.h5"])");
  REQUIRE(files.size() == 2);
  CHECK(fs::equivalent(files[0], kVehicle));
  CHECK(fs::equivalent(files[1], kQuarter));
  CHECK(fs::equivalent(shipped_trials(file_hash(kVehicle)), kVehicle));
  CHECK(shipped_trials("none").empty());
  refused([&] { named(R"(["hmwv_32mm"])"); }, "did you mean \"hmmwv_32mm\"?");
  refused([&] { named(R"(["nowhere/dataset.h5"])"); }, "there is no file");
  refused([&] { named(R"(["hmmwv_32mm", "hmmwv_32mm/dataset.h5"])"); }, "given twice");
}

TEST_CASE("a process on 16 fine and 200 coarse trials finds the fine curve better than on the fine alone") {
  OtherTrials others;
  others.own = {1};
  const learning::TrainingTable coarse = curved(200, 2, 1), test = curved(500, 0, 3);
  for (std::size_t n = 0; n < coarse.row_count(); ++n) {
    others.table.variables.insert(others.table.variables.end(), {coarse.row(n)[0], coarse.row(n)[1], 0});
    others.table.group.push_back(n);
  }
  others.table.variable_count = 3;
  others.table.outcome = coarse.outcome;
  others.table.weight = coarse.weight;
  double alone = 0, helped = 0;
  for (std::uint64_t seed = 10; seed < 15; ++seed) {
    const learning::TrainingTable fine = curved(16, 0, seed), both = others.joined(fine);
    alone += learning::brier_score(learning::fit_gaussian_process(fine, labels(fine)).probabilities(test.variables),
                                   labels(test));
    helped += learning::brier_score(
        learning::fit_gaussian_process(both, labels(both)).probabilities(others.at_own(test.variables, 2)),
        labels(test));
  }
  INFO("Brier score alone " << alone / 5 << ", helped " << helped / 5);
  CHECK(helped < 0.7 * alone);
}

TEST_CASE("no length of a process of half of the HMMWV's trials and a quarter wheel's gains by standing much shorter") {
  const campaign::Dataset dataset = campaign::read_dataset(kVehicle);
  TrainingData data = make_training_data(dataset.records, {});
  temper_weights(data, 0);
  const std::vector<std::size_t> fold = learning::assign_folds(data.table, 2, 1);
  std::vector<std::size_t> seen, unseen;
  for (std::size_t n = 0; n < fold.size(); ++n) (fold[n] == 0 ? unseen : seen).push_back(n);
  const learning::TrainingTable table = other_trials(kVehicle, {kData / "quarter_wheel_90mm/dataset.h5"})
                                            .away_from(data.table.subset(unseen))
                                            .joined(data.table.subset(seen));
  const std::vector<int> label = passable_labels(table);
  const learning::Standardisation scaling = learning::standardisation_of(table);
  std::vector<double> rows = table.variables;
  for (std::size_t k = 0; k < rows.size(); ++k) rows[k] = scaling.standardised(k % table.variable_count, rows[k]);
  const learning::GaussianProcessSettings settings;
  const auto height = [&](const learning::KernelLogs& logs) {
    double result = learning::laplace_evidence(rows, label, table.weight, logs).value;
    for (std::size_t v = 0; v < table.variable_count; ++v)
      result -= 0.5 * std::pow((logs[v] - std::log(settings.prior_length)) / settings.prior_width, 2);
    return result;
  };
  const learning::KernelLogs logs = learning::fit_gaussian_process(table, label, settings).logs();
  const double found = height(logs);
  std::printf("%zu rows: %.2f nat\n", table.row_count(), found);
  std::size_t tried = 0;
  for (std::size_t v = 0; v < table.variable_count; ++v) {
    learning::KernelLogs shorter = logs;
    shorter[v] = std::log(2.0);
    if (shorter[v] > logs[v] - std::log(2.0)) continue;
    INFO("variable " << v << " of length " << std::exp(logs[v]));
    CHECK(height(shorter) < found + 1);
    ++tried;
  }
  CHECK(tried > 3);
}

TEST_CASE("a teacher that sees the speeds of trials forecasts others better than a process that sees who passed") {
  const TrainingData data = make_training_data(campaign::read_dataset(kVehicle).records, {});
  std::vector<std::size_t> first, rest;
  for (std::size_t n = 0; n < data.table.row_count(); ++n) (n < 200 ? first : rest).push_back(n);
  const learning::TrainingTable seen = data.table.subset(first), unseen = data.table.subset(rest);
  const std::vector<int> happened = passable_labels(unseen);
  learning::TrainingTable blind = seen;
  blind.margin.clear();
  const double plain = learning::brier_score(process_baseline(seen, {}, unseen.variables), happened);
  const double mirrored = learning::brier_score(Teacher(blind, {})(unseen.variables), happened);
  const double graded = learning::brier_score(Teacher(seen, {})(unseen.variables), happened);
  std::printf("Brier score of the process %.4f, of the teacher without speeds %.4f, with them %.4f\n", plain, mirrored,
              graded);
  CHECK(mirrored < 0.95 * plain);
  CHECK(graded < 0.9 * mirrored);
}

TEST_CASE("a teacher learns from either side where both are alike, and where they are not, each for itself") {
  const std::size_t width = campaign::contract().variables.size();
  const std::size_t along = campaign::contract().variable_index("slope_along"),
                    across = campaign::contract().variable_index("slope_across");
  // P(go) falls with the slope along, and with the slope across to both sides (tilt 0) or to the left alone.
  const auto trials = [&](std::size_t count, bool one_sided, std::uint64_t seed) {
    learning::TrainingTable table;
    table.variable_count = width;
    for (std::size_t n = 0; n < count; ++n) {
      std::vector<double> point(width, 0.0);
      const double a = point[along] = 40 * random_unit(seed, 0, n) - 10,
                   b = point[across] = 50 * random_unit(seed, 1, n) - 25;
      table.variables.insert(table.variables.end(), point.begin(), point.end());
      const double side = one_sided ? std::max(0.0, b) : std::abs(b);
      const bool passes = random_unit(seed, 2, n) < 1 / (1 + std::exp(0.6 * (a - 20 + 0.9 * side)));
      table.outcome.push_back(
          campaign::contract().outcome_index(passes ? campaign::Verdict::go : campaign::Verdict::no_go,
                                             passes ? campaign::Reason::none : campaign::Reason::timeout));
      table.weight.push_back(1);
      table.group.push_back(n);
    }
    return table;
  };
  for (const bool one_sided : {false, true}) {
    double process = 0, taught = 0;
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      const learning::TrainingTable seen = trials(80, one_sided, seed), test = trials(2000, one_sided, seed + 100);
      process += learning::brier_score(process_baseline(seen, {}, test.variables), passable_labels(test)) / 6;
      taught += learning::brier_score(Teacher(seen, {})(test.variables), passable_labels(test)) / 6;
    }
    std::printf("%s: Brier score of the process %.4f, of the teacher %.4f\n", one_sided ? "one-sided" : "alike",
                process, taught);
    CHECK(taught < (one_sided ? 1.02 : 0.97) * process);
  }
}

TEST_CASE("a model that other trials helped names them, and has other bits than one that they did not") {
  const fs::path alone = scratch() / "alone.h5", helped = scratch() / "helped.h5";
  std::vector<std::uint64_t> first(40);
  std::iota(first.begin(), first.end(), 0u);
  TrainRequest request{.dataset = kVehicle,
                       .model = alone,
                       .seed = 5,
                       .learning = Config::parse(R"({"epochs": 4, "folds": 2, "negative": "persistent"})", "study"),
                       .design = {},
                       .groups = first};
  CHECK(train_model(request).others.empty());
  request.model = helped;
  const fs::path few = scratch() / "few.h5";
  campaign::Dataset quarter = campaign::read_dataset(kQuarter);
  quarter.records.resize(60);
  campaign::write_dataset(few, quarter);
  request.others = {few};
  const TrainingReport report = train_model(request);
  CHECK(report.others.at(0).trials == 60);
  CHECK(report_text(report).find("60 other trials help: quarter of a vehicle") != std::string::npos);
  CHECK_FALSE(learning::read_model(helped).weights == learning::read_model(alone).weights);
}

TEST_CASE("every second taught point of a family has a vehicle of its other trials, and both kinds fill the box") {
  const std::vector<campaign::Variable>& variables = campaign::contract().variables;
  const std::size_t width = variables.size(), load = campaign::contract().variable_index("load_number"),
                    slope = campaign::contract().variable_index("slope_along");
  std::vector<double> lower(width, 0), upper(width, 0);
  for (std::size_t v = 0; v < width; ++v) upper[v] = campaign::is_family_variable(variables[v]) || v == slope ? 1 : 0;
  OtherTrials others;
  others.own = {1, 1, 3, 1, 1};
  others.table.variable_count = width + others.own.size();
  for (const double grains : {3.0, 2.0}) {  // of the own fidelity, and of another
    std::vector<double> row(width, grains == 3 ? 0.9 : 0.2);
    row.insert(row.end(), {1, 1, grains, 1, 1});
    others.table.variables.insert(others.table.variables.end(), row.begin(), row.end());
    others.table.outcome.push_back(0);
  }
  const TaughtPoints points = taught_points(lower, upper, 256, 3, others);
  REQUIRE(points.joint_every == 2);
  std::array<int, 2> steep{}, heavy{}, moved{};  // even and odd points
  for (std::size_t k = 0; k < 256; ++k) {
    const double load_number = points.values[k * width + load];
    steep[k % 2] += points.values[k * width + slope] > 0.5;
    heavy[k % 2] += load_number > 0.5;
    moved[k % 2] += std::abs(load_number - 0.9) > 0.0251;
  }
  CHECK(steep == std::array{64, 64});  // of 128 each, as a Sobol' sequence has them
  CHECK(heavy == std::array{64, 128});
  CHECK(moved[1] == 0);
  others.own[2] = 4;  // now neither row is of the own fidelity
  const TaughtPoints alone = taught_points(lower, upper, 256, 3, others);
  CHECK(alone.joint_every == 1);
  upper.assign(width, 0);
  upper[slope] = 1;  // one vehicle, no family
  others.own[2] = 3;
  CHECK(taught_points(lower, upper, 256, 3, others).joint_every == 1);
}
