// Rows that are drawn from a model, against its exact distributions.
#include "pipeline/outcome/sampling/rows_file.h"

#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <sstream>

#include "base/error.h"
#include "base/files/file.h"
#include "base/hdf5/hdf5.h"
#include "learning/model/posterior.h"
#include "pipeline/outcome/answer/infer.h"
#include "pipeline/outcome/training_data.h"
#include "tests/pipeline/outcome/random_machine.h"
#include "tests/support/catch.h"
#include "tests/support/refused.h"
#include "tests/support/temporary_folder.h"

using namespace gonogo;
using namespace gonogo::campaign;
using namespace gonogo::outcome;

namespace {

/// Thermometer of `units` units a variable.
learning::Model small_model(std::size_t hidden, double size, int units = 2) {
  learning::Model model = random_machine({.hidden = hidden, .size = size, .units = units});
  give_trials(model);
  return model;
}

RowRequest request_for(const std::map<std::string, double>& known, std::size_t rows) {
  RowRequest request;
  request.known = to_variables(known);
  request.rows = rows;
  request.burn_in = 200;
  request.every = 3;
  return request;
}

std::vector<double> outcome_shares(const SampledRows& rows) {
  std::vector<double> share(contract().outcomes.size(), 0.0);
  for (std::size_t y : rows.outcome) share[y] += 1 / double(rows.row_count());
  return share;
}

/// Largest difference to exact marginals of outcome and variables, in standard errors by the effective number of rows.
double largest_z(const learning::Model& model, const RowRequest& request, const SampledRows& rows,
                 const learning::InputPrior& prior) {
  const learning::JointAnswer exact =
      learning::Posterior(model.layout, model.weights, prior).joint(request.known, request.outcome);
  double worst = 0;
  const auto compare = [&](double share, double p, double effective) {
    if (p * effective > 5) worst = std::max(worst, std::abs(share - p) / std::sqrt(p * (1 - p) / effective));
  };
  const double effective = std::min(rows.of_outcome.effective, double(rows.row_count()));
  const std::vector<double> outcomes = outcome_shares(rows);
  for (std::size_t y = 0; y < outcomes.size() && !request.outcome; ++y)
    compare(outcomes[y], exact.outcome.probability[y], effective);
  for (std::size_t v = 0; v < rows.variable_count; ++v)
    for (std::size_t bin = 0; bin < exact.variables[v].probability.size(); ++bin) {
      double share = 0;
      for (std::size_t n = 0; n < rows.row_count(); ++n)
        share += model.layout.encoders()[v].bin_of(rows.row(n)[v]) == int(bin);
      compare(share / double(rows.row_count()), exact.variables[v].probability[bin],
              std::min(rows.of_variable[v].effective, double(rows.row_count())));
    }
  return worst;
}

}  // namespace

TEST_CASE("every sampler gives the machine's own marginals, with known values and without") {
  const learning::Model model = small_model(5, 0.7);
  const Predictor predictor(model);
  for (const auto& known : {std::map<std::string, double>{},
                            {{"slope_along", 12.3}, {"friction_angle", 31}, {"payload", 700}, {"bed_depth", 0.2}}})
    for (const char* sampler : {"exact", "code_words", "tempering", "block_gibbs", "anneal", "population"}) {
      RowRequest request = request_for(known, 6000);
      request.sampler = sampler;
      const SampledRows rows = sample_rows(predictor, request);
      if (known.empty()) {  // too many rows to sum: the one-to-one comparison is with exact rows
        if (std::string(sampler) == "exact") continue;
        request.sampler = "exact";
        const std::vector<double> exact = outcome_shares(sample_rows(predictor, request)), own = outcome_shares(rows);
        for (std::size_t y = 0; y < own.size(); ++y) CHECK(std::abs(own[y] - exact[y]) < 0.03);
        continue;
      }
      const double z = largest_z(model, request, rows, {});
      std::printf("%-12s largest difference to exact marginals %.1f standard errors\n", sampler, z);
      CHECK(z < 4.5);
      CHECK(rows.sampler == sampler);
    }
}

TEST_CASE("rows of one outcome have the variables that it makes probable") {
  const learning::Model model = small_model(5, 0.7);
  const Predictor predictor(model);
  RowRequest request = request_for({{"slope_along", 5}, {"cohesion", 3}, {"payload", 700}, {"bed_depth", 0.2}}, 6000);
  request.outcome = 2;
  for (const char* sampler : {"exact", "tempering", "block_gibbs", "anneal"}) {
    request.sampler = sampler;
    const SampledRows rows = sample_rows(predictor, request);
    CHECK(largest_z(model, request, rows, {}) < 4.5);
    CHECK(std::count(rows.outcome.begin(), rows.outcome.end(), std::size_t(2)) == 6000);
    CHECK(std::isnan(rows.of_outcome.r_hat));
  }
  request.sampler = "auto";
  request.source = RowSource::prior;
  const SampledRows rows = sample_rows(predictor, request);
  CHECK(std::count(rows.outcome.begin(), rows.outcome.end(), std::size_t(2)) == 6000);
}

TEST_CASE("rows from the prior are its product with P(outcome | variables)") {
  const learning::Model model = small_model(5, 0.7);
  const Predictor predictor(model);
  RowRequest request = request_for({{"slope_along", 5}, {"payload", 700}, {"bed_depth", 0.2}, {"cohesion", 3}}, 6000);
  request.source = RowSource::prior;
  request.inside = false;  // the sum is over middles of bins
  for (const auto outcome : {std::optional<std::size_t>(), std::optional<std::size_t>(1)}) {
    request.outcome = outcome;
    const SampledRows rows = sample_rows(predictor, request);
    CHECK(rows.independent);
    CHECK(largest_z(model, request, rows, model.input_prior) < 4.5);
  }
}

TEST_CASE("values lie inside their bins or on the middles, known ones stay, fixed ones keep their value") {
  const learning::Model model = small_model(5, 0.7);
  const Predictor predictor(model);
  RowRequest request = request_for({{"slope_along", 12.3}}, 500);
  const std::size_t slope = contract().variable_index("slope_along");
  std::size_t between = 0;
  for (const bool inside : {true, false}) {
    request.inside = inside;
    const SampledRows rows = sample_rows(predictor, request);
    for (std::size_t n = 0; n < rows.row_count(); ++n)
      for (std::size_t v = 0; v < rows.variable_count; ++v) {
        const learning::Encoder& encoder = model.layout.encoders()[v];
        const double x = rows.row(n)[v];
        CHECK((x >= encoder.lower() && x <= encoder.upper()));
        if (v == slope)
          CHECK(x == 12.3);
        else if (!inside)
          CHECK(x == encoder.value(encoder.bin_of(x)));
        else
          between += x != encoder.value(encoder.bin_of(x));
      }
  }
  CHECK(between > 1000);
}

TEST_CASE("rows depend on the seed, not on threads") {
  const Predictor predictor(small_model(5, 0.7));
  for (const char* sampler : {"tempering", "exact", "block_gibbs"}) {
    RowRequest request = request_for({}, 200);
    request.sampler = sampler;
    omp_set_num_threads(1);
    const SampledRows one = sample_rows(predictor, request);
    omp_set_num_threads(3);
    CHECK(sample_rows(predictor, request).values == one.values);
    omp_set_num_threads(1);
    request.seed = 2;
    CHECK(sample_rows(predictor, request).values != one.values);
  }
}

TEST_CASE("chains that stay where they started are named") {
  // One strong hidden unit makes two wells that block Gibbs hardly leaves.
  learning::Model model = small_model(3, 0.1);
  for (std::size_t i = 0; i < model.layout.input_unit_count(); ++i) model.weights.weight[i * 3] = 3;
  model.weights.hidden_bias[0] = -1.5 * double(model.layout.input_unit_count());
  for (std::size_t i = 0; i < model.layout.input_unit_count(); ++i) model.weights.visible_bias[i] = -1.5;
  const Predictor predictor(model);
  RowRequest request = request_for({}, 400);
  const auto report = [&](const char* sampler) {
    request.sampler = sampler;
    return rows_report(predictor, request, sample_rows(predictor, request));
  };
  const RowsReport stuck = report("code_words"), exact = report("exact");
  CHECK(stuck.mixed == false);
  CHECK(stuck.largest_r_hat > 1.1);
  CHECK(rows_text(stuck).find("NOT MIXED") != std::string::npos);
  CHECK(exact.mixed == true);
  CHECK(rows_text(exact).find("NOT MIXED") == std::string::npos);
}

TEST_CASE("rows are written as CSV and HDF5 with all their digits") {
  const TemporaryFolder folder;
  const Predictor predictor(small_model(5, 0.7));
  const RowRequest request = request_for({{"slope_along", 12.3}}, 30);
  const SampledRows rows = sample_rows(predictor, request);
  const RowsReport report = rows_report(predictor, request, rows);
  write_rows(folder / "rows.csv", predictor, rows, report);
  std::istringstream csv(read_file(folder / "rows.csv"));
  std::string line;
  std::getline(csv, line);
  CHECK(line.rfind("slope_along,", 0) == 0);
  CHECK(line.find(",outcome") == line.size() - 8);
  for (std::size_t n = 0; n < 30; ++n) {
    REQUIRE(std::getline(csv, line));
    std::istringstream cells(line);
    std::string cell;
    for (double x : rows.row(n)) {
      std::getline(cells, cell, ',');
      CHECK(std::stod(cell) == x);
    }
    std::getline(cells, cell);
    CHECK(cell == contract().outcomes[rows.outcome[n]].name);
  }
  CHECK_FALSE(std::getline(csv, line));
  write_rows(folder / "rows.h5", predictor, rows, report);
  const Hdf5Reader in(folder / "rows.h5");
  CHECK(in.array<double>("variables", Shape{30, rows.variable_count}) == rows.values);
  CHECK(in.array<std::int32_t>("outcome", Shape{30}) ==
        std::vector<std::int32_t>(rows.outcome.begin(), rows.outcome.end()));
  CHECK(in.array<std::uint32_t>("chain", Shape{30}) == rows.chain);
  refused([&] { write_rows(folder / "rows.txt", predictor, rows, report); }, ".csv or .h5");
}

TEST_CASE("requests that cannot be met are refused") {
  learning::Model model = small_model(5, 0.7);
  const Predictor predictor(model);
  const auto with = [&](auto&& change) {
    RowRequest request = request_for({}, 10);
    change(request);
    return [request, &predictor] { sample_rows(predictor, request); };
  };
  refused(with([](RowRequest& r) { r.rows = 0; }), "at least one row");
  refused(with([](RowRequest& r) { r.chains = 0; }), "start at 1");
  refused(with([](RowRequest& r) { r.sampler = "gibs"; }), "\"gibs\" does not exist; use one of: auto, exact");
  refused(with([](RowRequest& r) { r.outcome = 99; }), "outcome 99 does not exist");
  refused(with([](RowRequest& r) { r.known.pop_back(); }), "values where the model has");
  refused(with([](RowRequest& r) {
            r.source = RowSource::prior;
            r.sampler = "anneal";
          }),
          "leave out the sampler anneal");
  model.weights.visible_bias.back() = -60;
  const Predictor never(model);
  RowRequest request = request_for({}, 10);
  request.source = RowSource::prior;
  request.outcome = contract().outcomes.size() - 1;
  refused([&] { sample_rows(never, request); }, "is below 0.0001");
  model.input_prior.clear();
  const Predictor without(model);
  request.outcome.reset();
  refused([&] { sample_rows(without, request); }, "no prior of its inputs");
  learning::Model large = small_model(40, 0.1, 8);
  const Predictor too_large(large);
  request.source = RowSource::machine;
  request.sampler = "exact";
  refused([&] { sample_rows(too_large, request); }, "take another sampler");
}
