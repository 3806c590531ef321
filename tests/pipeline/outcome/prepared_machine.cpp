// What an export does for machines whose rows are seldom code words: the outcome's balance and the penalty.
#include "pipeline/outcome/qubo/prepared_machine.h"

#include <cmath>
#include <cstdio>
#include <sstream>

#include "base/files/file.h"
#include "learning/encoding/layout.h"
#include "learning/formats/dimod.h"
#include "learning/model/posterior.h"
#include "pipeline/outcome/qubo/qubo_exchange.h"
#include "pipeline/outcome/training_data.h"
#include "tests/pipeline/outcome/random_machine.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"

using namespace gonogo;
using namespace gonogo::campaign;
using namespace gonogo::outcome;

namespace {

/// One unit for each of seven variables makes all their words code words; ten outcomes.
learning::Model small_model(double outcome_bias, std::size_t hidden, double size) {
  return random_machine({.hidden = hidden, .size = size, .outcome_bias = outcome_bias});
}

/// Hidden unit 0 is on in about half of the code words, and in nearly all rows, since it turns on many of the units
/// from `first` up to `last`.
void crowd(learning::Model& model, std::size_t first, std::size_t last) {
  model.weights.hidden_bias[0] = -2.7;
  for (std::size_t i = first; i < last; ++i) {
    model.weights.visible_bias[i] = -2.5;
    model.weights.weight[i * model.weights.hidden_count] = 2.7;
  }
}

/// 4,000 exact rows of problem.json, imported. "worth" is the square of the sum of weights over the sum of squares.
Json exact_answer(const TemporaryFolder& folder) {
  ImportRequest import;
  import.problem = folder.path() / "problem.json";
  import.answer = folder.path() / "answer.json";
  import.limits = {.reads = 1, .share = 0};
  import.rows = folder.path() / "rows.csv";
  sample_problem(import.problem, import.answer, *learning::make_sampler("exact"),
                 {.reads = 4000, .seed = 11, .sweeps = 1});
  Json json = to_json(import_answer(import));
  std::istringstream csv(read_file(import.rows));
  double sum = 0, squares = 0;
  std::string line;
  std::getline(csv, line);
  while (std::getline(csv, line)) {
    const double weight = std::stod(line.substr(line.rfind(',') + 1));
    sum += weight;
    squares += weight * weight;
  }
  json["worth"] = sum * sum / squares;
  return json;
}

/// A code word of all variables by the bits of `inputs`, one outcome, and hidden units by the bits of `hidden`.
std::vector<std::int8_t> row_with(const learning::Model& model, std::size_t inputs, std::size_t outcome,
                                  std::size_t hidden) {
  const std::size_t first = model.layout.input_unit_count(), visible = model.layout.unit_count();
  std::vector<std::int8_t> row(visible + model.weights.hidden_count, 0);
  for (std::size_t i = 0; i < first; ++i) row[i] = std::int8_t(inputs >> i & 1);
  row[first + outcome] = 1;
  for (std::size_t j = 0; j < model.weights.hidden_count; ++j) row[visible + j] = std::int8_t(hidden >> j & 1);
  return row;
}

std::vector<double> free_units(const learning::Model& model) {
  return std::vector<double>(model.weights.visible_count + model.weights.hidden_count, NAN);
}

}  // namespace

TEST_CASE("a balanced machine keeps the energies of all code words and couples no two visible units") {
  const learning::Model model = small_model(3, 4, 2);
  const std::size_t visible = model.layout.unit_count();
  const learning::Problem plain = learning::to_qubo(model.weights, model.layout.unit_labels());
  const learning::Problem balanced = balanced_machine(model);
  for (const learning::Coupling& coupling : balanced.couplings) {
    CHECK(coupling.a < visible);
    CHECK(coupling.b >= visible);
  }
  REQUIRE_FALSE(balanced == plain);
  double largest = 0;
  for (std::size_t inputs = 0; inputs < std::size_t(1) << model.layout.input_unit_count(); ++inputs)
    for (std::size_t outcome = 0; outcome < model.layout.outcome_count(); ++outcome)
      for (std::size_t hidden = 0; hidden < 16; ++hidden) {
        const auto row = row_with(model, inputs, outcome, hidden);
        largest = std::max(largest, std::abs(energy(balanced, row) - energy(plain, row)));
      }
  CHECK(largest < 1e-10);
}

TEST_CASE("one outcome unit of a balanced machine is on in the mean, given the hidden units of its code words") {
  const learning::Model model = small_model(3, 4, 2);
  const std::size_t first = model.layout.input_unit_count(), visible = model.layout.unit_count();
  const learning::Problem plain = learning::to_qubo(model.weights, model.layout.unit_labels());
  const learning::Problem balanced = balanced_machine(model);
  // P(hidden) over code words by enumeration, and the outcome units on given the hidden ones.
  double total = 0, on_plain = 0, on_balanced = 0;
  std::vector<double> moment(4, 0.0);
  for (std::size_t hidden = 0; hidden < 16; ++hidden) {
    double weight = 0;
    for (std::size_t inputs = 0; inputs < std::size_t(1) << first; ++inputs)
      for (std::size_t outcome = 0; outcome < model.layout.outcome_count(); ++outcome)
        weight += std::exp(-energy(plain, row_with(model, inputs, outcome, hidden)));
    const auto on_of = [&](const learning::Problem& problem) {
      double on = 0;
      auto row = row_with(model, 0, 0, hidden);
      row[first] = 0;
      const double none = energy(problem, row);
      for (std::size_t y = first; y < visible; ++y) {
        row[y] = 1;
        on += 1 / (1 + std::exp(energy(problem, row) - none));
        row[y] = 0;
      }
      return on;
    };
    total += weight;
    on_plain += weight * on_of(plain);
    on_balanced += weight * on_of(balanced);
    for (std::size_t j = 0; j < 4; ++j)
      if (hidden >> j & 1) moment[j] += weight * (on_of(balanced) - 1);
  }
  std::printf("outcome units on in the mean: %.3f before, %.3f balanced\n", on_plain / total, on_balanced / total);
  CHECK(on_plain / total > 5);
  CHECK(on_balanced / total == Approx(1).margin(0.1));  // 512 rows estimate the means
  for (const double m : moment) CHECK(std::abs(m / total) < 0.1);
}

TEST_CASE("export balances outcomes where weighed rows are worth little, says so, and answers stay the machine's") {
  const TemporaryFolder folder;
  const auto file = folder.path() / "model.h5", problem = folder.path() / "problem.json";
  const learning::Model calm = small_model(-2.5, 4, 1);
  learning::write_model(file, calm);
  const Exported plain = export_problem(file, problem, {}, learning::Vartype::binary);
  CHECK(plain.sidecar.code_penalty == 0);
  CHECK(contains(plain.notes.back(), "No penalty is needed"));
  CHECK(learning::problem_from_dimod_json(read_file(problem), "problem") ==
        learning::to_qubo(calm.weights, calm.layout.unit_labels()));

  learning::Model crowded = calm;
  crowd(crowded, crowded.layout.input_unit_count(), crowded.layout.unit_count());
  learning::write_model(file, crowded);
  export_problem(file, problem, {}, learning::Vartype::binary, {}, 0.0);  // as it is
  const Json before = exact_answer(folder);
  const Exported exported = export_problem(file, problem, {}, learning::Vartype::binary);
  CHECK(exported.sidecar.code_penalty == 0);
  CHECK(contains(exported.notes.back(), "the outcome's units are balanced"));
  const Json after = exact_answer(folder);
  std::printf("weights of 4,000 reads are worth %.0f, balanced %.0f\n", before.at("worth").number(),
              after.at("worth").number());
  CHECK(before.at("worth").number() < 400);
  CHECK(after.at("worth").number() > 2000);
  CHECK(after.at("invalid_share").number() < before.at("invalid_share").number());
  const auto own = learning::Posterior(crowded.layout, crowded.weights).marginal(std::vector<double>(9, NAN));
  for (std::size_t y = 0; y < own.probability.size(); ++y) {
    const Json& entry = after.at("outcomes").at(contract().outcomes[y].name);
    CHECK(entry.at("machine").number() == Approx(own.probability[y]).margin(1e-9));
    CHECK(std::abs(entry.at("frequency").number() - own.probability[y]) < 4 * entry.at("standard_error").number());
  }
}

TEST_CASE("shares of code words measured with many hidden units agree with exact sums, and stand in the note") {
  const TemporaryFolder folder;
  for (const char* code : {"binary", "gray", "thermometer"}) {
    const learning::Model few = random_machine({.hidden = 4, .code = code, .units = 2, .outcome_bias = -1});
    const auto exact = word_shares(balanced_machine(few), few.layout, free_units(few));
    REQUIRE(exact);
    CHECK(exact->exact);
    // The same machine with hidden units that nothing is coupled to: more than can be summed, and no other row.
    learning::Model many = few;
    many.weights = learning::RbmWeights::zeros(few.weights.visible_count, 20);
    many.weights.visible_bias = few.weights.visible_bias;
    for (std::size_t i = 0; i < few.weights.visible_count; ++i)
      for (std::size_t j = 0; j < 4; ++j) many.weights.weight[i * 20 + j] = few.weights.weight[i * 4 + j];
    std::copy(few.weights.hidden_bias.begin(), few.weights.hidden_bias.end(), many.weights.hidden_bias.begin());
    const auto measured = word_shares(balanced_machine(many), many.layout, free_units(many));
    REQUIRE(measured);
    CHECK_FALSE(measured->exact);
    std::printf("%s: code words %.3f, measured %.3f; reads are worth %.3f, measured %.3f\n", code, exact->words,
                measured->words, exact->weighed, measured->weighed);
    CHECK(measured->words == Approx(exact->words).epsilon(0.1));
    CHECK(measured->weighed == Approx(exact->weighed).epsilon(0.1));
    learning::write_model(folder.path() / "model.h5", many);
    const Exported exported =
        export_problem(folder.path() / "model.h5", folder.path() / "problem.json", {}, learning::Vartype::binary);
    CHECK(exported.sidecar.code_penalty == 0);
    CHECK(contains(exported.notes.back(), "about "));
    CHECK(contains(exported.notes.back(), "of the machine's rows are code words"));
  }
}

TEST_CASE("the measured penalty is the first that leaves code words in nine of ten rows") {
  // Without weights n of the ten outcome units are on with weight C(10, n) exp(b n - s (1 - n)^2).
  const auto word_share = [](double bias, double strength) {
    double sum = 0, one = 0, choose = 1;
    for (int n = 0; n <= 10; ++n) {
      const double weight = choose * std::exp(bias * n - strength * (1 - n) * (1 - n));
      sum += weight;
      if (n == 1) one = weight;
      choose *= double(10 - n) / (n + 1);
    }
    return one / sum;
  };
  for (const double bias : {2.0, 6.0, 10.0, 14.0, 22.0, 40.0}) {
    double expected = 32;
    for (const double strength : {32.0, 24.0, 16.0, 12.0, 8.0})
      if (word_share(bias, strength) >= 0.9) expected = strength;
    const learning::Model model = small_model(bias, 1, 0);
    const learning::Problem machine = learning::to_qubo(model.weights, model.layout.unit_labels());
    INFO("bias " << bias);
    CHECK(measured_penalty(machine, model.layout, free_units(model)) == expected);
  }
}

TEST_CASE("a variable whose units crowd is beyond the outcome's balance, so its words get a penalty") {
  const TemporaryFolder folder;
  const auto file = folder.path() / "model.h5", problem = folder.path() / "problem.json";
  learning::Model model = random_machine({.hidden = 4, .size = 0.3, .code = "one_hot", .units = 12});
  const std::size_t slope = model.layout.variable_index("slope_along");
  crowd(model, model.layout.offset(slope), model.layout.offset(slope) + 12);
  learning::write_model(file, model);
  const Exported exported = export_problem(file, problem, {}, learning::Vartype::binary);
  CHECK(exported.sidecar.code_penalty == 8);
  CHECK(contains(exported.notes.back(), "penalty of 8"));
  sample_problem(problem, folder.path() / "answer.json", *learning::make_sampler("tempering"),
                 {.reads = 500, .seed = 2, .sweeps = 300});
  ImportRequest import;
  import.problem = problem;
  import.answer = folder.path() / "answer.json";
  import.decoding = Decoding::discard;
  CHECK(to_json(import_answer(import)).at("invalid_share").number() < 0.1);
  // Clamped, the crowd has left the problem.
  CHECK(export_problem(file, problem, {{"slope_along", 12}}, learning::Vartype::binary).sidecar.code_penalty == 0);
}
