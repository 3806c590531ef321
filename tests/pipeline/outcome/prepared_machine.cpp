// What an export does for machines whose rows are seldom code words: free units.
#include "pipeline/outcome/qubo/prepared_machine.h"

#include <cmath>
#include <cstdio>

#include "base/files/file.h"
#include "base/format.h"
#include "learning/formats/dimod.h"
#include "learning/model/posterior.h"
#include "pipeline/outcome/qubo/qubo_exchange.h"
#include "tests/pipeline/outcome/random_machine.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/refused.h"
#include "tests/support/temporary_folder.h"

using namespace gonogo;
using namespace gonogo::campaign;
using namespace gonogo::outcome;

namespace {

learning::KnownPart nothing(const learning::Model& model) {
  return {std::vector<double>(model.layout.variable_count(), NAN), {}};
}

std::string hidden_label(const learning::Problem& problem, std::size_t i) {
  const std::string label = learning::label_text(problem.labels[i]);
  return label.starts_with("hidden:") ? label : "";
}

/// P(outcome) over code words, by the posterior's own sums.
std::vector<double> outcomes_of(const learning::Model& model, const learning::KnownPart& known) {
  return learning::Posterior(model.layout, model.weights).marginal(known.variables).probability;
}

/// Sum over all hidden units and outcomes of exp(-energy) of the code words by enumeration, and over all patterns of
/// the free units: the logs of both for every state of the hidden units.
struct Sums {
  std::vector<double> words, free;
};

Sums enumerated(const learning::Problem& words, const learning::Problem& problem,
                const learning::VisibleLayout& layout) {
  const std::size_t inputs = layout.input_unit_count(), visible = layout.unit_count();
  const std::size_t hidden = words.variable_count() - visible, free = problem.variable_count() - hidden;
  Sums sums;
  for (std::size_t h = 0; h < std::size_t(1) << hidden; ++h) {
    std::vector<double> terms;
    std::vector<std::int8_t> row(words.variable_count(), 0);
    for (std::size_t j = 0; j < hidden; ++j) row[visible + j] = std::int8_t(h >> j & 1);
    for (std::size_t x = 0; x < std::size_t(1) << inputs; ++x)
      for (std::size_t y = 0; y < layout.outcome_count(); ++y) {
        for (std::size_t i = 0; i < inputs; ++i) row[i] = std::int8_t(x >> i & 1);
        for (std::size_t k = 0; k < layout.outcome_count(); ++k) row[inputs + k] = k == y;
        terms.push_back(-energy(words, row));
      }
    sums.words.push_back(learning::log_sum_exp(terms));
    terms.clear();
    row.assign(problem.variable_count(), 0);
    for (std::size_t j = 0; j < hidden; ++j) row[free + j] = std::int8_t(h >> j & 1);
    for (std::size_t u = 0; u < std::size_t(1) << free; ++u) {
      for (std::size_t k = 0; k < free; ++k) row[k] = std::int8_t(u >> k & 1);
      terms.push_back(-energy(problem, row));
    }
    sums.free.push_back(learning::log_sum_exp(terms));
  }
  return sums;
}

}  // namespace

TEST_CASE("free units couple with hidden units alone, and rows weighed are the machine's, by enumeration") {
  // Seven variables of two words and an outcome of ten: 16 free units.
  const learning::Model model = random_machine({.hidden = 4, .size = 2, .outcome_bias = 3});
  const PreparedMachine prepared = machine_of_free_units(model, nothing(model));
  REQUIRE(prepared.words);
  const learning::Problem& problem = prepared.problem;
  for (const learning::Coupling& c : problem.couplings)
    CHECK(hidden_label(problem, c.a).empty() != hidden_label(problem, c.b).empty());
  const CodeMachine machine = prepared.code_machine(model.layout);
  const auto exact = machine.exact();
  REQUIRE(exact);
  const Sums sums = enumerated(*prepared.words, problem, model.layout);
  double words = 0, free = 0, square = 0;
  for (std::size_t h = 0; h < sums.words.size(); ++h) {
    words += std::exp(sums.words[h]);
    free += std::exp(sums.free[h]);
    square += std::exp(2 * sums.words[h] - sums.free[h]);
  }
  const double worth = words / free * words / square;
  std::printf("16 free units for 4 hidden ones: weighed reads are worth %.4f\n", worth);
  CHECK(exact->weighed_share == Approx(worth).epsilon(1e-9));
  CHECK(exact->word_share == 1);
  CHECK(worth > 0.95);
  std::vector<std::int8_t> row(problem.variable_count(), 0);
  const CodeMachine::Given none = machine.given(row);
  for (std::size_t h = 0; h < sums.words.size(); ++h) {
    for (std::size_t i = 0, j = 0; i < row.size(); ++i)
      if (!hidden_label(problem, i).empty()) row[i] = std::int8_t(h >> j++ & 1);
    const CodeMachine::Given given = machine.given(row);
    CHECK(given.log_words - none.log_words == Approx(sums.words[h] - sums.words[0]).margin(1e-9));
    CHECK(given.log_all - none.log_all == Approx(sums.free[h] - sums.free[0]).margin(1e-9));
  }
  const std::vector<double> own = outcomes_of(model, nothing(model));
  for (std::size_t y = 0; y < own.size(); ++y) CHECK(machine.exact_outcomes()[y] == Approx(own[y]).margin(1e-9));
}

TEST_CASE("reads of free units are worth a third and more for many hidden units, and known values leave the problem") {
  const learning::Model model = random_machine({.hidden = 24, .size = 1, .units = 5, .outcome_bias = -1});
  learning::KnownPart known = nothing(model);
  for (const bool is_clamped : {false, true}) {
    if (is_clamped) known.variables[model.layout.variable_index("slope_along")] = 12;
    const PreparedMachine prepared = machine_of_free_units(model, known);
    CHECK(prepared.problem.variable_count() == 20 + 24);
    CHECK(prepared.words->variable_count() == model.layout.unit_count() + 24 - (is_clamped ? 5 : 0));
    const WordShares shares = word_shares(prepared.code_machine(model.layout));
    std::printf("20 free units for 24 hidden ones: weighed reads are worth %.2f\n", shares.weighed);
    CHECK(shares.words == 1);
    CHECK(shares.weighed > 0.3);
  }
}

TEST_CASE("export takes free units where plain rows are worth little, says so, and answers stay the machine's") {
  const TemporaryFolder folder;
  const auto file = folder.path() / "model.h5", problem = folder.path() / "problem.json",
             answer = folder.path() / "answer.json";
  const learning::Model calm = random_machine({.hidden = 4, .outcome_bias = -2.5});
  learning::write_model(file, calm);
  const Exported plain = export_problem(file, problem, {}, learning::Vartype::binary);
  CHECK(contains(plain.notes.back(), "No penalty is needed"));
  CHECK_FALSE(plain.sidecar.words);
  CHECK(learning::problem_from_dimod_json(read_file(problem), "problem") ==
        learning::to_qubo(calm.weights, calm.layout.unit_labels()));

  const learning::Model model = random_machine({.hidden = 8, .size = 1.5, .units = 4, .outcome_bias = 2});
  learning::write_model(file, model);
  for (const auto vartype : {learning::Vartype::binary, learning::Vartype::spin}) {
    const std::map<std::string, double> clamped = {{"slope_along", 12}};
    const Exported exported = export_problem(file, problem, clamped, vartype);
    CHECK(contains(exported.notes.back(), "free units stand for the code words"));
    CHECK(exported.sidecar.code_penalty == 0);
    REQUIRE(exported.sidecar.words);
    CHECK(read_sidecar(learning::sidecar_path(problem)).words == exported.sidecar.words);
    sample_problem(problem, answer, *learning::make_sampler("exact"), {.reads = 4000, .seed = 11, .sweeps = 1});
    ImportRequest import;
    import.problem = problem;
    import.answer = answer;
    const Json json = to_json(import_answer(import));
    CHECK(json.at("invalid_share").number() == 0);
    CHECK(json.at("independent_reads").number() > 1000);
    learning::KnownPart known = nothing(model);
    known.variables[model.layout.variable_index("slope_along")] = 12;
    const std::vector<double> own = outcomes_of(model, known);
    for (std::size_t y = 0; y < own.size(); ++y) {
      const Json& entry = json.at("outcomes").at(contract().outcomes[y].name);
      CHECK(entry.at("machine").number() == Approx(own[y]).margin(1e-9));
      CHECK(std::abs(entry.at("frequency").number() - own[y]) < 4 * entry.at("standard_error").number());
    }
    import.decoding = Decoding::discard;
    refused([&] { import_answer(import); }, "free units in place of code words");
  }
}

TEST_CASE("an export that asks for a penalty, or for none, says how many of its rows are code words") {
  const TemporaryFolder folder;
  const auto file = folder.path() / "model.h5", problem = folder.path() / "problem.json";
  const learning::Model model = random_machine({.hidden = 8, .size = 1.5, .units = 4, .outcome_bias = 2});
  learning::write_model(file, model);
  const auto note = [&](double penalty) {
    const Exported exported = export_problem(file, problem, {}, learning::Vartype::binary, {}, penalty);
    REQUIRE(exported.notes.size() == 1);
    return exported.notes.front();
  };
  const auto words = [&](double penalty) {
    const auto machine = CodeMachine::of(penalised_machine(model, nothing(model), penalty), model.layout);
    return number_text(100 * machine->exact()->word_share, 2) + " % of the rows are code words";
  };
  const std::string plain = note(0), penalised = note(6);
  std::printf("%s\n%s\n", plain.c_str(), penalised.c_str());
  CHECK(contains(plain, "Without a penalty " + words(0)));
  CHECK(contains(plain, "Leave --penalty out"));
  CHECK(contains(penalised, "With a penalty of 6 " + words(6)));
  CHECK(words(0) != words(6));
}

TEST_CASE("outcomes are exact with many hidden units where few words are free") {
  const learning::Model model = random_machine({.hidden = 20, .size = 1, .units = 3});
  learning::KnownPart known = nothing(model);
  for (double& value : known.variables) value = 0;
  known.variables[model.layout.variable_index("slope_along")] = NAN;
  const PreparedMachine prepared = machine_of_free_units(model, known);
  const CodeMachine::Reference found = prepared.code_machine(model.layout).outcomes();
  const std::vector<double> own = outcomes_of(model, known);
  for (std::size_t y = 0; y < own.size(); ++y) {
    CHECK(found.probability[y] == Approx(own[y]).margin(1e-9));
    CHECK(found.standard_error[y] == 0);
  }
}

TEST_CASE("free units of another machine are refused") {
  const learning::Model model = random_machine({.hidden = 4}), other = random_machine({.hidden = 6});
  const PreparedMachine one = machine_of_free_units(model, nothing(model)),
                        two = machine_of_free_units(other, nothing(other));
  refused([&] { CodeMachine::with_free_units(*two.words, one.problem, model.layout); }, "export it again");
  learning::Problem coupled = one.problem;
  coupled.couplings.insert(coupled.couplings.begin(), {0, 1, 0.5});  // two free units
  refused([&] { CodeMachine::with_free_units(*one.words, coupled, model.layout); }, "export it again");
}

TEST_CASE("machines whose every row is one of code words go out as they are") {
  learning::Model model = random_machine({.hidden = 20, .code = "gray", .units = 2});
  learning::KnownPart known = nothing(model);
  known.outcome = 0;
  CHECK_FALSE(prepared_machine(model, known).words);
  known.outcome.reset();
  CHECK(prepared_machine(model, known).words);
}
