// Eight chains side by side against one chain alone and against exact answers.
#include <cmath>
#include <cstdio>

#include "base/error.h"
#include "learning/sampler/chains/spins.h"
#include "learning/sampler/exact.h"
#include "learning/sampler/sampler.h"
#include "tests/support/catch.h"
#include "tests/support/draw.h"

using namespace gonogo;
using namespace gonogo::learning;

namespace {

Problem random_spins(std::size_t count, double share, double size, std::uint64_t seed) {
  test::Draw draw(seed);
  Problem problem;
  problem.vartype = Vartype::spin;
  for (std::size_t i = 0; i < count; ++i) {
    problem.labels.emplace_back(std::int64_t(i));
    problem.linear.push_back(draw.between(-size, size));
  }
  for (std::uint32_t a = 0; a < count; ++a)
    for (std::uint32_t b = a + 1; b < count; ++b)
      if (draw.between(0, 1) < share) problem.couplings.push_back({a, b, draw.between(-size, size)});
  return problem;
}

/// Largest deviation of means and pair means from the exact ones in standard errors.
double largest_z(const Problem& problem, const SampleSet& rows) {
  const ExactMoments exact = exact_moments(problem);
  const double n = double(rows.row_count());
  double worst = 0;
  const auto look = [&](auto&& value, double mean) {
    double sum = 0;
    for (std::size_t r = 0; r < rows.row_count(); ++r) sum += value(rows.row(r)) / n;
    worst = std::max(worst, std::abs(sum - mean) / std::sqrt((1 - mean * mean) / n));
  };
  for (std::size_t i = 0; i < problem.variable_count(); ++i)
    look([&](auto row) { return double(row[i]); }, exact.mean[i]);
  for (std::size_t k = 0; k < problem.couplings.size(); ++k)
    look([&](auto row) { return double(row[problem.couplings[k].a] * row[problem.couplings[k].b]); },
         exact.pair_mean[k]);
  return worst;
}

}  // namespace

TEST_CASE("the draws of eight lanes are those of eight chains") {
  const std::uint64_t first = 0xFFFFFFFCu;  // the chain's number goes beyond 32 bits within the eight
  LaneRandom lanes(3, first, 39);
  for (std::uint64_t row : {std::uint64_t(0), std::uint64_t(7), std::uint64_t(1) << 33}) {
    lanes.begin(row);
    for (std::size_t unit = 0; unit < 39; ++unit) {
      const auto words = lanes(unit);
      for (int l = 0; l < kLanes; ++l) {
        ChainRandom chain(3, first + std::uint64_t(l), 39);
        chain.begin(row);
        CHECK((double(words[l]) + 0.5) * 0x1.0p-32 == chain(unit));
      }
    }
  }
}

TEST_CASE("an annealed chain has the same bits in any company") {
  const Problem problem = random_spins(40, 0.2, 1, 1);
  const auto annealer = make_sampler("anneal");
  const SampleSet few = annealer->sample(problem, {.reads = 3, .seed = 5, .sweeps = 100});
  const SampleSet many = annealer->sample(problem, {.reads = 20, .seed = 5, .sweeps = 100});
  CHECK(std::equal(few.values.begin(), few.values.end(), many.values.begin()));
  CHECK_FALSE(std::equal(many.row(0).begin(), many.row(0).end(), many.row(8).begin()));
}

TEST_CASE("fitted betas find ground states at any scale of energies, and the answer says them") {
  Problem problem = random_spins(16, 0.5, 100, 7);
  double lowest = INFINITY;
  for (std::uint32_t state = 0; state < 1u << 16; ++state) {
    std::vector<std::int8_t> row(16);
    for (std::size_t i = 0; i < 16; ++i) row[i] = state >> i & 1 ? 1 : -1;
    lowest = std::min(lowest, energy(problem, row));
  }
  SampleSet first;
  for (const double scale : {1.0, 0x1p-20, 0x1p20}) {
    Problem scaled = problem;
    for (double& h : scaled.linear) h *= scale;
    for (Coupling& c : scaled.couplings) c.value *= scale;
    const SampleSet rows = make_sampler("anneal")->sample(scaled, {.reads = 200, .seed = 3, .sweeps = 100});
    const auto hits = std::count_if(rows.energies.begin(), rows.energies.end(),
                                    [&](double e) { return e <= scale * (lowest + 1e-9 * std::abs(lowest)); });
    std::printf("scale %g: %ld of 200 rows are ground states, beta %.3g to %.3g\n", scale, long(hits),
                rows.info.at("beta_start").number(), rows.info.at("beta_end").number());
    CHECK(hits > 40);
    CHECK(rows.info.at("schedule").string() == "geometric");
    if (scale == 1) first = rows;
    CHECK(rows.values == first.values);  // powers of two: the same numbers but for their exponents
    CHECK(rows.info.at("beta_end").number() * scale == Approx(first.info.at("beta_end").number()).epsilon(1e-12));
  }
  for (double& h : problem.linear) h *= 0x1p-20;
  for (Coupling& c : problem.couplings) c.value *= 0x1p-20;
  const SampleSet raw = make_sampler("anneal", {{"beta_start", 0.1}, {"beta_end", 1.0}})
                            ->sample(problem, {.reads = 200, .seed = 3, .sweeps = 100});
  CHECK(std::count_if(raw.energies.begin(), raw.energies.end(), [&](double e) {
          return e <= 0x1p-20 * (lowest + 1e-9 * std::abs(lowest));
        }) < 10);  // betas in raw units are far too hot here
  // Weak fields on one spin alone: half of the flips are accepted first, one row in a hundred is turned at the end.
  Problem one = random_spins(1, 0, 1, 1);
  one.linear = {0.25};
  const SampleSet rows = make_sampler("anneal")->sample(one, {.reads = 20'000, .seed = 1, .sweeps = 4});
  CHECK(rows.info.at("beta_start").number() == Approx(std::log(2) / 0.5));
  CHECK(std::count(rows.values.begin(), rows.values.end(), 1) == Approx(200).margin(60));
  CHECK_THROWS_AS(make_sampler("anneal", {{"schedule", std::string("cubic")}})->sample(one, {}), InputError);
}

TEST_CASE("moments of annealed rows are exact within their errors") {
  const Problem problem = random_spins(14, 0.4, 0.7, 2);
  for (const double start : {0.05, 1.0}) {
    const SampleSet rows = make_machine_sampler("anneal", {{"beta_start", start}})
                               ->sample(problem, {.reads = 20'000, .seed = 4, .sweeps = 200});
    const double worst = largest_z(problem, rows);
    std::printf("anneal from beta %.2f: largest z of %zu moments %.2f\n", start,
                problem.variable_count() + problem.couplings.size(), worst);
    CHECK(worst < 4);
  }
}

TEST_CASE("terms that 24 bits would lose beside a penalty are sampled right") {
  Problem problem = random_spins(10, 0.5, 0.8, 3);
  CHECK(single_precision_holds(SpinGraph(problem), 1));
  const Problem small = problem;
  // An eleventh spin, pinned down by a large field, pulls at all others, and their own fields make up for it: energies
  // of what is free stay as they are.
  const double large = 3e7;
  problem.labels.emplace_back(std::int64_t(10));
  problem.linear.push_back(1e3 * large);
  for (std::uint32_t i = 0; i < 10; ++i) {
    problem.linear[i] += large;
    problem.couplings.push_back({i, 10, large});
  }
  std::sort(problem.couplings.begin(), problem.couplings.end(),
            [](const Coupling& x, const Coupling& y) { return std::pair(x.a, x.b) < std::pair(y.a, y.b); });
  CHECK_FALSE(single_precision_holds(SpinGraph(problem), 1));
  const SampleSet rows = make_machine_sampler("anneal")->sample(problem, {.reads = 10'000, .seed = 4, .sweeps = 200});
  SampleSet free;
  free.vartype = Vartype::spin;
  free.labels = small.labels;
  for (std::size_t r = 0; r < rows.row_count(); ++r) {
    REQUIRE(rows.row(r)[10] == -1);
    free.values.insert(free.values.end(), rows.row(r).begin(), rows.row(r).begin() + 10);
    free.energies.push_back(0);
    free.occurrences.push_back(1);
  }
  CHECK(largest_z(small, free) < 4);
}
