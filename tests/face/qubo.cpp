#include <gonogo/qubo.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "tests/support/catch.h"

using namespace gonogo::api;

namespace {

struct Folder {
  std::filesystem::path path = std::filesystem::temp_directory_path() / "gonogo_face_qubo";
  Folder() { std::filesystem::create_directories(path); }
  ~Folder() { std::filesystem::remove_all(path); }
};

/// E = 1 + a - 2 b + 3 a b over {0, 1}.
Problem two() { return {.labels = {"a", "7"}, .linear = {1, -2}, .couplings = {{0, 1, 3}}, .offset = 1}; }

}  // namespace

TEST_CASE("energies of the face are those of the formula, in both vartypes and after a file") {
  const Folder folder;
  const Problem spins = to_vartype(two(), Vartype::spin);
  for (const std::int8_t a : {0, 1})
    for (const std::int8_t b : {0, 1}) {
      const double expected = 1 + a - 2 * b + 3 * a * b;
      CHECK(energy(two(), {a, b}) == Approx(expected));
      CHECK(energy(spins, {std::int8_t(2 * a - 1), std::int8_t(2 * b - 1)}) == Approx(expected));
    }
  const auto file = folder.path / "two.json";
  CHECK(write_problem(two(), file).empty());
  const Problem read = read_problem(file);
  CHECK(read.labels == two().labels);
  CHECK(read.linear == two().linear);
  CHECK(read.offset == 1);
  CHECK(problem_formats().size() > 2);
  CHECK_THROWS_AS(energy(two(), {1}), InputError);
  CHECK_THROWS_AS(energy({.linear = {1, 2}, .couplings = {{1, 0, 3}}}, {0, 0}), InputError);
  CHECK_THROWS_AS(read_problem(folder.path / "none.json"), InputError);
}

TEST_CASE("a sampler of the face draws states as often as the Boltzmann distribution says") {
  const SampleSet rows = sample(two(), {.name = "exact"}, {.count = 20000, .seed = 3});
  double z = 0, ones = 0, reads = 0;
  for (const int a : {0, 1})
    for (const int b : {0, 1}) z += std::exp(-(1.0 + a - 2 * b + 3 * a * b));
  for (std::size_t r = 0; r < rows.energies.size(); ++r) {
    reads += double(rows.occurrences[r]);
    if (rows.values[2 * r] == 0 && rows.values[2 * r + 1] == 1) ones += double(rows.occurrences[r]);
  }
  CHECK(reads == 20000);
  CHECK(ones / reads == Approx(std::exp(1.0) / z).margin(0.015));
  const auto all = samplers();
  CHECK(std::any_of(all.begin(), all.end(), [](const SamplerInfo& s) { return s.name == "tempering"; }));
  CHECK_THROWS_AS(sample(two(), {.name = "magic"}, {}), InputError);
  CHECK_THROWS_AS(sample(two(), {.name = "anneal", .settings = {{"no_such", 1.0}}}, {}), InputError);
}

TEST_CASE("a model's problem goes over an annealer's qubits and comes back as outcomes") {
  const Folder folder;
  const auto problem = folder.path / "problem.json", answer = folder.path / "answer.json";
  export_problem({.model = "quarter_wheel_90mm", .problem = problem, .clamped = {{"slope_along", 12}}});
  CHECK(sample_file(problem, answer, {.name = "tempering"}, {.count = 1500}).reads == 1500);
  const ImportedAnswer read = import_answer({.problem = problem, .answer = answer, .rows = folder.path / "rows.csv"});
  CHECK(read.reads == 1500);
  CHECK(read.bias != "biased");
  REQUIRE_FALSE(read.outcomes.empty());
  double sum = 0;
  for (const ReadOutcome& o : read.outcomes) sum += o.frequency;
  CHECK(sum == Approx(1));
  CHECK(std::filesystem::exists(folder.path / "rows.csv"));
  CHECK_THROWS_AS(import_answer({.problem = problem, .answer = answer, .decoding = "guess"}), InputError);

  const auto embedded = folder.path / "embedded.json";
  const EmbedResult laid = embed({.problem = problem, .out = embedded, .dead_share = 0.02});
  CHECK(laid.qubits > laid.variables);
  CHECK(laid.chain_strength > 0);
  const SampleReport emulated = sample_emulated(problem, answer, {.dead_share = 0.02}, {.count = 100, .sweeps = 100});
  CHECK(emulated.reads == 100);
  CHECK(emulated.energy_lowest <= emulated.energy_mean);
}
