// Tabu search against optima by enumeration: of all states, and of all tours.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/error.h"
#include "learning/sampler/sampler.h"
#include "tests/support/catch.h"
#include "tests/support/draw.h"
#include "tests/support/refused.h"

using namespace gonogo;
using namespace gonogo::learning;

namespace {

/// Coefficients that differ by factors of up to 10^decades.
Problem random_problem(std::size_t count, Vartype vartype, double decades, test::Draw& draw) {
  const auto coefficient = [&] {
    return draw.between(-1, 1) * std::pow(10.0, draw.between(-decades / 2, decades / 2));
  };
  Problem problem;
  problem.vartype = vartype;
  problem.offset = coefficient();
  for (std::uint32_t a = 0; a < count; ++a) {
    problem.labels.emplace_back(std::int64_t(a));
    problem.linear.push_back(coefficient());
    for (std::uint32_t b = a + 1; b < count; ++b)
      if (draw.between(0, 1) < 0.5) problem.couplings.push_back({a, b, coefficient()});
  }
  return problem;
}

double lowest_of_all(const Problem& problem) {
  const std::size_t n = problem.variable_count();
  std::vector<std::int8_t> row(n);
  double lowest = INFINITY;
  for (std::uint32_t state = 0; state < 1u << n; ++state) {
    for (std::size_t i = 0; i < n; ++i)
      row[i] = state >> i & 1 ? 1 : problem.vartype == Vartype::spin ? std::int8_t(-1) : std::int8_t(0);
    lowest = std::min(lowest, energy(problem, row));
  }
  return lowest;
}

double lowest_of(const SampleSet& rows) { return *std::min_element(rows.energies.begin(), rows.energies.end()); }

/// Distances between cities in the unit square.
std::vector<std::vector<double>> random_map(std::size_t cities, test::Draw& draw) {
  std::vector<std::pair<double, double>> place;
  for (std::size_t i = 0; i < cities; ++i) place.emplace_back(draw.between(0, 1), draw.between(0, 1));
  std::vector<std::vector<double>> distance(cities, std::vector<double>(cities));
  for (std::size_t i = 0; i < cities; ++i)
    for (std::size_t j = 0; j < cities; ++j)
      distance[i][j] = std::hypot(place[i].first - place[j].first, place[i].second - place[j].second);
  return distance;
}

/// x_ik = 1: the tour from city 0 visits city i + 1 as stop k. Every city has one stop and every stop one city, or the
/// energy rises by 2.
Problem tour_problem(const std::vector<std::vector<double>>& distance) {
  const auto rest = std::uint32_t(distance.size() - 1);
  const auto at = [&](std::uint32_t i, std::uint32_t k) { return i * rest + k; };
  Problem problem;
  problem.vartype = Vartype::binary;
  for (std::uint32_t v = 0; v < rest * rest; ++v) problem.labels.emplace_back(std::int64_t(v));
  problem.linear.assign(rest * rest, -4);
  problem.offset = 4.0 * rest;
  for (std::uint32_t i = 0; i < rest; ++i) {
    problem.linear[at(i, 0)] += distance[0][i + 1];
    problem.linear[at(i, rest - 1)] += distance[0][i + 1];
  }
  for (std::uint32_t i = 0; i < rest; ++i)
    for (std::uint32_t k = 0; k < rest; ++k)
      for (std::uint32_t j = 0; j < rest; ++j)
        for (std::uint32_t l = 0; l < rest; ++l) {
          if (at(i, k) >= at(j, l)) continue;
          const bool follows = l == k + 1 || k == l + 1;
          const double value = (i == j) + (k == l) > 0 ? 4 : follows ? distance[i + 1][j + 1] : 0;
          if (value != 0) problem.couplings.push_back({at(i, k), at(j, l), value});
        }
  return problem;
}

double shortest_of_all(const std::vector<std::vector<double>>& distance) {
  std::vector<std::size_t> order(distance.size() - 1);
  std::iota(order.begin(), order.end(), 1);
  double shortest = INFINITY;
  do {
    double length = distance[0][order.front()] + distance[order.back()][0];
    for (std::size_t k = 0; k + 1 < order.size(); ++k) length += distance[order[k]][order[k + 1]];
    shortest = std::min(shortest, length);
  } while (std::next_permutation(order.begin(), order.end()));
  return shortest;
}

}  // namespace

TEST_CASE("tabu search finds the lowest energy of every small problem") {
  test::Draw draw(5);
  for (int k = 0; k < 120; ++k) {
    const Problem problem =
        random_problem(1 + std::size_t(k) % 14, k % 2 ? Vartype::spin : Vartype::binary, k % 3 == 0 ? 8 : 1, draw);
    const SampleSet rows = make_sampler("tabu")->sample(problem, {.reads = 4, .seed = std::uint64_t(k), .sweeps = 500});
    const double lowest = lowest_of_all(problem);
    INFO("problem " << k << " of " << problem.variable_count() << " variables");
    CHECK(lowest_of(rows) == Approx(lowest).epsilon(1e-12).margin(1e-12));
    for (std::size_t r = 0; r < 4; ++r) CHECK(rows.energies[r] == energy(problem, rows.row(r)));
  }
}

TEST_CASE("tabu search finds the shortest of all tours of nine cities") {
  std::ptrdiff_t all_hits = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    test::Draw draw(seed);
    const auto distance = random_map(9, draw);
    const SampleSet rows =
        make_sampler("tabu")->sample(tour_problem(distance), {.reads = 20, .seed = seed, .sweeps = 3000});
    const double shortest = shortest_of_all(distance);
    const auto hits =
        std::count_if(rows.energies.begin(), rows.energies.end(), [&](double e) { return e < shortest + 1e-9; });
    std::printf("tours, seed %d: shortest %.6f, found by %d of 20 reads\n", int(seed), shortest, int(hits));
    CHECK(lowest_of(rows) == Approx(shortest).epsilon(1e-9));
    all_hits += hits;
  }
  CHECK(all_hits >= 60);
}

TEST_CASE("a longer tabu search is never worse, nor one with a tenure of its own choice useless") {
  test::Draw draw(8);
  const Problem problem = random_problem(90, Vartype::spin, 1, draw);
  const SampleSet start = make_sampler("tabu")->sample(problem, {.reads = 10, .seed = 2, .sweeps = 0});
  std::vector<double> before = start.energies;
  for (const std::size_t sweeps : {1, 10, 100, 200, 1000, 5000}) {
    const SampleSet rows = make_sampler("tabu")->sample(problem, {.reads = 10, .seed = 2, .sweeps = sweeps});
    for (std::size_t r = 0; r < 10; ++r) CHECK(rows.energies[r] <= before[r]);
    before = rows.energies;
  }
  for (const std::int64_t tenure : {1, 7, 1000}) {  // a tenure beyond all spins makes them all rest at times
    const SamplerSettings settings{{"tenure", tenure}, {"patience", std::int64_t(50)}};
    CHECK(lowest_of(make_sampler("tabu", settings)->sample(problem, {.reads = 10, .seed = 2, .sweeps = 2000})) <
          lowest_of(start) / 2);
  }
  refused([] { make_sampler("tabu", {{"tenure", std::int64_t(-1)}}); }, "tenure must be at least 0");
}

TEST_CASE("problems without variables or couplings are searched as well") {
  Problem problem;
  problem.vartype = Vartype::binary;
  CHECK(make_sampler("tabu")->sample(problem, {.reads = 3}).row_count() == 3);
  problem.labels = {std::string("a"), std::string("b")};
  problem.linear = {-1.5, 0};
  CHECK(lowest_of(make_sampler("tabu")->sample(problem, {.reads = 3, .sweeps = 5})) == -1.5);
}
