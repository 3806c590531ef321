// Machines of code words against sums over all their rows.
#include "learning/machine/word_machine.h"

#include <omp.h>

#include <cmath>

#include "base/error.h"
#include "learning/model/posterior.h"
#include "tests/learning/words.h"
#include "tests/support/catch.h"

using namespace gonogo;
using namespace gonogo::learning;

namespace {

/// Chi-squared of counts against probabilities, less its mean, in its standard deviations. Rare rows are one cell.
double surprise(const std::vector<double>& count, const std::vector<double>& probability) {
  double total = 0, sum = 0, cells = 0, rare_count = 0, rare = 0;
  for (double c : count) total += c;
  const auto add = [&](double c, double expected) {
    if (expected <= 0) return;
    sum += (c - expected) * (c - expected) / expected;
    cells += 1;
  };
  for (std::size_t k = 0; k < count.size(); ++k) {
    if (probability[k] * total >= 10) {
      add(count[k], probability[k] * total);
    } else {
      rare_count += count[k];
      rare += probability[k] * total;
    }
  }
  add(rare_count, rare);
  return (sum - (cells - 1)) / std::sqrt(2 * (cells - 1));
}

/// Counts of rows of independent chains, each read once after `sweeps`.
std::vector<double> chain_counts(const WordMachine& machine, std::size_t rungs, std::size_t sweeps, std::size_t rows) {
  WordChains chains(20'000, rungs, 7);
  chains.run(machine, sweeps);
  std::vector<double> count(rows, 0.0);
  for (std::size_t c = 0; c < chains.chains(); ++c) ++count[words::place_of(machine, chains.row(c))];
  return count;
}

}  // namespace

TEST_CASE("log Z of code words is the sum over all rows, from either side") {
  const VisibleLayout layout = words::mixed_layout();
  for (const std::size_t hidden : {3, 14}) {
    const RbmWeights weights = words::random_machine(layout.unit_count(), hidden, 2, hidden);
    const WordMachine machine(layout, weights);
    CHECK(machine.word_count() == 4 + 3 + 4 + 3);
    CHECK(ExactWords(machine).log_z() == Approx(words::enumerate(layout, weights).log_z).epsilon(1e-12));
  }
}

TEST_CASE("rows of code words have the probabilities of the sum over all rows") {
  const VisibleLayout layout = words::mixed_layout();
  for (const std::size_t hidden : {3, 14}) {
    const RbmWeights weights = words::random_machine(layout.unit_count(), hidden, 1, 20 + hidden);
    const WordMachine machine(layout, weights);
    const std::vector<double> exact = words::enumerate(layout, weights).probability;
    const ExactWords drawer(machine);
    std::vector<double> count(exact.size(), 0.0);
    for (std::uint64_t row = 0; row < 20'000; ++row) ++count[words::place_of(machine, drawer.draw(3, row))];
    CHECK(surprise(count, exact) < 4);
    CHECK(surprise(chain_counts(machine, 1, 60, exact.size()), exact) < 4);
    CHECK(surprise(chain_counts(machine, 1, 0, exact.size()), exact) > 40);  // chains start from uniform words
  }
}

TEST_CASE("exchanges between temperatures keep the distribution where words alone mix slowly") {
  // Two wells: strong weights of one hidden unit with the first two variables.
  const VisibleLayout layout = words::mixed_layout();
  RbmWeights weights = words::random_machine(layout.unit_count(), 3, 0.5, 4);
  for (std::size_t i = 0; i < layout.offset(2); ++i) weights.weight[i * 3] = 4;
  weights.hidden_bias[0] = -9;
  const WordMachine machine(layout, weights);
  const std::vector<double> exact = words::enumerate(layout, weights).probability;
  CHECK(surprise(chain_counts(machine, 1, 3, exact.size()), exact) > 10);
  CHECK(surprise(chain_counts(machine, 4, 40, exact.size()), exact) < 4);
}

TEST_CASE("known values and outcomes enter as in the posterior, between the middles of bins too") {
  const VisibleLayout layout = words::mixed_layout();
  const RbmWeights weights = words::random_machine(layout.unit_count(), 5, 1.5, 8);
  const std::vector<double> known = {1.3, NAN, NAN, 2.2};
  const JointAnswer answer = Posterior(layout, weights).joint(known, std::nullopt);
  std::vector<double> log_p;
  for (std::size_t y = 0; y < 3; ++y)
    log_p.push_back(weights.visible_bias[layout.input_unit_count() + y] +
                    ExactWords(WordMachine(layout, weights, {known, y})).log_z());
  normalise_logs(log_p);
  for (std::size_t y = 0; y < 3; ++y) CHECK(log_p[y] == Approx(answer.outcome.probability[y]).epsilon(1e-12));

  const WordMachine machine(layout, weights, {known, std::nullopt});
  REQUIRE(machine.groups().size() == 2);
  CHECK(machine.groups()[0].variable == 1);
  CHECK(machine.groups()[1].variable == -1);
  const ExactWords drawer(machine);
  std::vector<double> soil(3, 0.0);
  for (std::uint64_t row = 0; row < 20'000; ++row) ++soil[drawer.draw(5, row)[0]];
  CHECK(surprise(soil, answer.variables[1].probability) < 4);
}

TEST_CASE("rows of words are the same bits for any number of threads and in any pieces") {
  const VisibleLayout layout = words::mixed_layout();
  const WordMachine machine(layout, words::random_machine(layout.unit_count(), 5, 1, 8));
  const auto rows = [&](int threads, const std::vector<std::size_t>& pieces) {
    omp_set_num_threads(threads);
    WordChains chains(9, 3, 2);
    for (std::size_t sweeps : pieces) chains.run(machine, sweeps);
    std::vector<std::uint16_t> all;
    for (std::size_t c = 0; c < 9; ++c) all.insert(all.end(), chains.row(c).begin(), chains.row(c).end());
    return all;
  };
  const auto once = rows(1, {12});
  CHECK(rows(3, {12}) == once);
  CHECK(rows(2, {5, 7}) == once);
  CHECK(rows(2, {5, 6}) != once);
  omp_set_num_threads(1);
}

TEST_CASE("units of a drawn row are its code words") {
  const VisibleLayout layout = words::mixed_layout();
  const WordMachine machine(layout, words::random_machine(layout.unit_count(), 2, 1, 8));
  for (const auto& row : words::all_rows(layout)) {
    const std::vector<std::uint16_t> drawn = {std::uint16_t(row[0]), std::uint16_t(row[1]), std::uint16_t(row[3]),
                                              std::uint16_t(row[4])};
    std::vector<Bit> units(layout.unit_count(), 0);
    machine.write_units(drawn, units);
    CHECK(std::vector<double>(units.begin(), units.end()) == words::units_of(layout, row));
  }
}

TEST_CASE("machines of code words refuse what does not match, and what is too large to enumerate") {
  const VisibleLayout layout = words::mixed_layout();
  const RbmWeights weights = RbmWeights::zeros(layout.unit_count(), 2);
  CHECK_THROWS_AS(WordMachine(layout, RbmWeights::zeros(3, 2)), InputError);
  CHECK_THROWS_AS(WordMachine(layout, weights, {{1, 2}, std::nullopt}), InputError);
  CHECK_THROWS_AS(WordMachine(layout, weights, {{}, 3}), InputError);
  CHECK_THROWS_AS(WordChains(0, 1, 1), InputError);
  CHECK_THROWS_AS(WordChains(1, 65, 1), InputError);
  std::vector<Encoder> many;
  for (int v = 0; v < 8; ++v)
    many.push_back(Encoder::by_range("v" + std::to_string(v), "-", Code::thermometer, 8, 0, 1));
  const VisibleLayout large(many, {"go", "no_go"});
  const WordMachine machine(large, RbmWeights::zeros(large.unit_count(), 30));
  CHECK_FALSE(ExactWords::possible(machine));
  CHECK_THROWS_AS(ExactWords(machine), InputError);
}
