// Answers at another temperature than the problem's: refused or corrected at any number of hidden units.
#include <cmath>
#include <cstdio>

#include "base/error.h"
#include "base/files/file.h"
#include "learning/model/model.h"
#include "pipeline/outcome/qubo/qubo_exchange.h"
#include "tests/pipeline/outcome/random_machine.h"
#include "tests/support/catch.h"
#include "tests/support/refused.h"

using namespace gonogo;
using namespace gonogo::outcome;

namespace {

MachineProblem exported_machine(std::size_t hidden, int units, std::optional<double> penalty = 0.0) {
  learning::Model model = random_machine({.hidden = hidden, .size = 1, .units = units});
  give_trials(model);
  return machine_problem(model, {}, learning::Vartype::binary, penalty);
}

/// Rows that follow exp(-beta E) of the machine.
learning::SampleSet rows_at(double beta, const learning::Problem& problem, std::size_t reads) {
  learning::Problem scaled = problem;
  for (double& h : scaled.linear) h *= beta;
  for (learning::Coupling& c : scaled.couplings) c.value *= beta;
  learning::SampleSet rows =
      learning::make_sampler("block_gibbs")->sample(scaled, {.reads = reads, .seed = 3, .sweeps = 300});
  for (std::size_t r = 0; r < rows.row_count(); ++r) rows.energies[r] = learning::energy(problem, rows.row(r));
  return rows;
}

DecodeSettings taking_all_reads() {
  DecodeSettings settings;
  settings.limits.reads = 1;
  settings.limits.share = 0;
  return settings;
}

}  // namespace

namespace {

/// What import did with answers at a wrong temperature.
struct Verdicts {
  int refused = 0, corrected = 0, taken = 0, biased = 0;
};

/// Twenty answers at beta 0.2 to 3, none of them 1.
Verdicts verdicts_of_planted(const MachineProblem& machine, const DecodeSettings& settings, std::size_t reads) {
  Verdicts verdicts;
  for (int k = 0; k < 20; ++k) {
    const double beta = 0.2 * std::pow(15.0, double(k) / 19.0);
    try {
      const auto answer =
          decode_answer_to(machine.problem, machine.sidecar, rows_at(beta, machine.problem, reads), settings, "answer");
      ++(answer.summary->temperature->verdict == "corrected" ? verdicts.corrected : verdicts.taken);
      verdicts.biased += answer.summary->bias.verdict == "biased";
    } catch (const InputError& error) {
      const std::string said = error.what();
      INFO("beta " << beta << ": " << said);
      CHECK((said.find("its rows have beta") != said.npos || said.find("independent ones") != said.npos));
      ++verdicts.refused;
    }
  }
  return verdicts;
}

Verdicts check_planted(const std::string& name, const MachineProblem& machine) {
  const Verdicts found = verdicts_of_planted(machine, DecodeSettings(), 1000);
  std::printf("%s, %zu variables: of 20 answers at beta 0.2 to 3, %d refused, %d corrected, %d taken as they are\n",
              name.c_str(), machine.problem.variable_count(), found.refused, found.corrected, found.taken);
  INFO(name);
  CHECK(found.refused == 18);  // all but 0.96 and 1.11
  CHECK(found.corrected == 2);
  CHECK(found.taken == 0);
  const auto right =
      decode_answer_to(machine.problem, machine.sidecar, rows_at(1, machine.problem, 1000), DecodeSettings(), "answer");
  CHECK(right.summary->temperature->verdict == "right");
  CHECK(right.summary->temperature->beta.low < 1.02);
  CHECK(right.summary->temperature->beta.high > 0.98);
  return found;
}

}  // namespace

TEST_CASE("of twenty answers at a wrong temperature none is taken as it is, at any number of hidden units") {
  for (const std::size_t hidden : {8, 16, 17, 96})
    CHECK(check_planted(std::to_string(hidden) + " hidden units", exported_machine(hidden, 3, std::nullopt)).biased ==
          0);
}

TEST_CASE("of twenty answers at a wrong temperature of the rover's model none is taken as it is") {
  const learning::Model model =
      learning::read_model(std::filesystem::path(GONOGO_SOURCE_DIR) / "data/viper_32mm/model.h5");
  check_planted("viper_32mm", machine_problem(model, {}, learning::Vartype::binary, std::nullopt));
}

TEST_CASE("where any beta is allowed, every answer is corrected or worth too few reads") {
  const MachineProblem machine = exported_machine(8, 3);
  const auto own = CodeMachine::of(machine.problem, machine.sidecar.layout)->outcomes();
  DecodeSettings settings;
  settings.limits.temperature = 10;
  const Verdicts found = verdicts_of_planted(machine, settings, 4000);
  std::printf("any beta allowed: of 20 answers %d refused, %d corrected, %d of these biased\n", found.refused,
              found.corrected, found.biased);
  CHECK(found.taken == 0);
  CHECK(found.corrected >= 5);
  CHECK(found.biased == 0);
}

TEST_CASE("rows a little too hot or too cold have the machine's outcomes once their weights are corrected") {
  const MachineProblem machine = exported_machine(8, 3);
  const auto own = CodeMachine::of(machine.problem, machine.sidecar.layout)->outcomes();
  for (const double beta : {0.87, 1.13}) {
    const learning::SampleSet rows = rows_at(beta, machine.problem, 40000);
    DecodeSettings settings = taking_all_reads();
    const auto largest_difference = [&] {
      const auto found = decode_answer_to(machine.problem, machine.sidecar, rows, settings, "answer").summary;
      CHECK(found->temperature->beta.beta == Approx(beta).margin(0.03));
      double largest = 0;
      for (std::size_t y = 0; y < found->outcomes.size(); ++y)
        largest = std::max(largest, std::abs(found->outcomes[y].frequency.mean - own.probability[y]));
      return largest;
    };
    const double corrected = largest_difference();
    settings.limits.temperature = INFINITY;
    const double as_drawn = largest_difference();
    std::printf("beta %.2f: an outcome is off by %.4f at most, %.4f once corrected\n", beta, as_drawn, corrected);
    CHECK(corrected < 0.5 * as_drawn);
  }
}

TEST_CASE("rows that tell no temperature are refused with the reason") {
  const MachineProblem machine = exported_machine(20, 1);
  const learning::SampleSet cold = rows_at(400, machine.problem, 200);
  refused([&] { decode_answer_to(machine.problem, machine.sidecar, cold, taking_all_reads(), "answer"); }, "beta");
  learning::SampleSet lowest = rows_at(1e6, machine.problem, 100);
  std::size_t best = 0;
  for (std::size_t r = 0; r < lowest.row_count(); ++r)
    if (lowest.energies[r] < lowest.energies[best]) best = r;
  const std::vector<std::int8_t> row(lowest.row(best).begin(), lowest.row(best).end());
  for (std::size_t r = 0; r < lowest.row_count(); ++r)
    std::copy(row.begin(), row.end(), lowest.values.begin() + std::ptrdiff_t(r * row.size()));
  refused([&] { decode_answer_to(machine.problem, machine.sidecar, lowest, taking_all_reads(), "answer"); },
          "tell no temperature");
}

TEST_CASE("a machine's own outcomes by chains agree with the exact sums") {
  learning::Model model = random_machine({.hidden = 14, .size = 1.5, .units = 3});
  give_trials(model);
  const MachineProblem small = machine_problem(model, {}, learning::Vartype::binary, 0.0);
  const auto exact = CodeMachine::of(small.problem, small.sidecar.layout)->outcomes();
  // Three more hidden units that are coupled to nothing change no probability, but are too many to sum.
  learning::RbmWeights& weights = model.weights;
  learning::RbmWeights wide = learning::RbmWeights::zeros(weights.visible_count, weights.hidden_count + 3);
  wide.visible_bias = weights.visible_bias;
  std::copy(weights.hidden_bias.begin(), weights.hidden_bias.end(), wide.hidden_bias.begin());
  for (std::size_t i = 0; i < weights.visible_count; ++i)
    std::copy_n(weights.weight.begin() + std::ptrdiff_t(i * weights.hidden_count), weights.hidden_count,
                wide.weight.begin() + std::ptrdiff_t(i * wide.hidden_count));
  weights = wide;
  const MachineProblem large = machine_problem(model, {}, learning::Vartype::binary, 0.0);
  const auto sampled = CodeMachine::of(large.problem, large.sidecar.layout)->outcomes();
  double worst = 0;
  for (std::size_t y = 0; y < exact.probability.size(); ++y) {
    CHECK(exact.standard_error[y] == 0);
    CHECK(sampled.standard_error[y] > 0);
    CHECK(sampled.standard_error[y] < 0.02);
    worst = std::max(worst, std::abs(sampled.probability[y] - exact.probability[y]) / sampled.standard_error[y]);
  }
  std::printf("largest difference of %zu outcomes: %.2f standard errors\n", exact.probability.size(), worst);
  CHECK(worst < 4);
}
