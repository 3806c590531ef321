#include <cmath>
#include <limits>

#include "base/error.h"
#include "learning/formats/dimod.h"
#include "learning/formats/format.h"
#include "learning/model/weights.h"
#include "learning/sampler/exact.h"
#include "tests/learning/toy.h"
#include "tests/support/catch.h"

using namespace gonogo;
using namespace gonogo::learning;

namespace {

// What dimod 0.12 writes with json.dumps(..., separators=(",", ":")).
const char* const kProblemA =
    R"({"type":"BinaryQuadraticModel","version":{"bqm_schema":"3.0.0"},"use_bytes":false,"index_type":"int32","bias_type":"float64","num_variables":2,"num_interactions":1,"variable_labels":["a","b"],"variable_type":"SPIN","offset":0.0,"info":{},"linear_biases":[-1.0,1.0],"quadratic_biases":[-1.0],"quadratic_head":[0],"quadratic_tail":[1]})";
const char* const kAnswer =
    R"({"type":"SampleSet","version":{"sampleset_schema":"3.2.0"},"num_variables":3,"num_rows":1,"sample_data":{"type":"array","data":[[2]],"data_type":"uint32","shape":[1,1],"use_bytes":false},"sample_type":"int8","sample_packed":true,"vectors":{"energy":{"type":"array","data":[-0.5],"data_type":"float64","shape":[1],"use_bytes":false},"num_occurrences":{"type":"array","data":[1],"data_type":"int64","shape":[1],"use_bytes":false}},"variable_labels":[0,1,2],"variable_type":"SPIN","info":{}})";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

/// A problem with every kind of coupling, for brute force.
Problem ring() {
  Problem problem;
  problem.labels = {"a", "b", "c", "d"};
  problem.linear = {0.5, -1.25, 0.75, 2};
  problem.couplings = {{0, 1, 1.5}, {0, 2, -0.5}, {1, 2, 0.25}, {2, 3, -3}};
  problem.offset = 0.125;
  return problem;
}

}  // namespace

TEST_CASE("spin and binary forms have the same energy in every state") {
  const Problem qubo = ring(), ising = to_ising(qubo), back = to_qubo(ising);
  for (int state = 0; state < 16; ++state) {
    std::vector<std::int8_t> x(4), s(4);
    for (int i = 0; i < 4; ++i) {
      x[std::size_t(i)] = std::int8_t(state >> i & 1);
      s[std::size_t(i)] = std::int8_t(2 * x[std::size_t(i)] - 1);
    }
    CHECK(energy(ising, s) == Approx(energy(qubo, x)).margin(1e-14));
    CHECK(energy(back, x) == Approx(energy(qubo, x)).margin(1e-14));
  }
}

TEST_CASE("the toy machine as an Ising problem") {
  const Problem ising = to_ising(to_qubo(toy_machine(), toy_labels()));
  const std::vector<double> h = {.3125, .125, -.0625, -.25, .1875, -.0625, 0};
  for (std::size_t i = 0; i < 7; ++i) CHECK(ising.linear[i] == Approx(h[i]).margin(1e-15));
  CHECK(ising.offset == Approx(.125).margin(1e-15));
  double expected[7][7] = {};
  expected[0][4] = .125;
  expected[0][5] = -.0625;
  expected[0][6] = .0625;
  expected[1][5] = .125;
  expected[1][6] = -.0625;
  expected[2][4] = -.125;
  expected[2][6] = .125;
  expected[3][4] = .0625;
  expected[3][5] = -.125;
  CHECK(ising.couplings.size() == 12);
  for (const Coupling& c : ising.couplings) CHECK(c.value == Approx(expected[c.a][c.b]).margin(1e-15));
}

TEST_CASE("clamped variables leave the energies of the others unchanged") {
  const Problem problem = ring();
  const Problem part = clamp(problem, std::vector<double>{NAN, 1, NAN, 0});
  CHECK(part.labels == std::vector<Label>{"a", "c"});
  for (int a = 0; a < 2; ++a)
    for (int c = 0; c < 2; ++c)
      CHECK(energy(part, std::vector<std::int8_t>{std::int8_t(a), std::int8_t(c)}) ==
            Approx(energy(problem, std::vector<std::int8_t>{std::int8_t(a), 1, std::int8_t(c), 0})).margin(1e-14));
}

TEST_CASE("problems are written and read as dimod does, byte for byte") {
  Problem a;
  a.vartype = Vartype::spin;
  a.labels = {"a", "b"};
  a.linear = {-1, 1};
  a.couplings = {{0, 1, -1}};
  CHECK(to_dimod_json(a) == kProblemA);
  CHECK(problem_from_dimod_json(kProblemA, "a.json") == a);

  Problem b;
  b.labels = {std::int64_t(0), std::int64_t(1)};
  b.linear = {0, 0};
  b.couplings = {{0, 1, 1}};
  const std::string text = to_dimod_json(b);
  CHECK(
      text.find(
          R"("variable_labels":[0,1],"variable_type":"BINARY","offset":0.0,"info":{},"linear_biases":[0.0,0.0],"quadratic_biases":[1.0],"quadratic_head":[0],"quadratic_tail":[1]})") !=
      std::string::npos);
  CHECK(problem_from_dimod_json(text, "b.json") == b);

  const Problem empty = problem_from_dimod_json(to_dimod_json(Problem{}), "empty.json");
  CHECK(empty.variable_count() == 0);
  CHECK(to_dimod_json(Problem{}).find(R"("num_variables":0,"num_interactions":0,"variable_labels":[])") !=
        std::string::npos);

  Problem odd = ring();
  odd.linear[0] = 1.0 / 3;
  odd.couplings[1].value = 1e-7;
  CHECK(problem_from_dimod_json(to_dimod_json(odd), "odd.json") == odd);
}

TEST_CASE("an interaction given with head above tail is the same interaction") {
  const Problem problem =
      problem_from_dimod_json(replaced(replaced(kProblemA, R"("quadratic_head":[0])", R"("quadratic_head":[1])"),
                                       R"("quadratic_tail":[1])", R"("quadratic_tail":[0])"),
                              "a.json");
  CHECK(problem.couplings == std::vector<Coupling>{{0, 1, -1}});
}

TEST_CASE("damaged problems are refused with the place") {
  const auto refused = [](const std::string& from, const std::string& to, const std::string& word) {
    try {
      problem_from_dimod_json(replaced(kProblemA, from, to), "p.json");
      FAIL("accepted: " << to);
    } catch (const InputError& e) {
      CAPTURE(from, to);
      CHECK(std::string(e.what()).find("p.json") == 0);
      CHECK(std::string(e.what()).find(word) != std::string::npos);
    }
  };
  refused(R"("linear_biases":[-1.0,1.0])", R"("linear_biases":[-1.0])", "linear_biases");
  refused(R"("linear_biases":[-1.0,1.0])", R"("linear_biases":[-1.0,null])", "linear_biases");
  refused(R"("linear_biases":[-1.0,1.0])", R"("linear_biases":[-1.0,"1"])", "linear_biases");
  refused(R"(["a","b"])", R"(["a","a"])", "twice");
  refused(R"(["a","b"])", R"(["a"])", "variable_labels");
  refused(R"("SPIN")", R"("DISCRETE")", "variable_type");
  refused(R"("quadratic_tail":[1])", R"("quadratic_tail":[2])", "quadratic_tail");
  refused(R"("quadratic_tail":[1])", R"("quadratic_tail":[0])", "coupling");
  refused(R"("quadratic_tail":[1])", R"("quadratic_tail":[1,1])", "quadratic_tail");
  refused(R"("use_bytes":false)", R"("use_bytes":true)", "use_bytes");
  refused(R"("3.0.0")", R"("9.0.0")", "bqm_schema");
  refused(R"("num_interactions":1)", R"("num_interactions":2)", "quadratic_biases");
  refused(R"("BinaryQuadraticModel")", R"("SampleSet")", "type");
  refused(R"("offset":0.0,)", "", "offset");
  refused(R"("quadratic_tail":[1]})", R"("quadratic_tail":[1]} x)", "JSON");
  refused(R"("quadratic_tail":[1]})", R"("quadratic_tail":[1])", "JSON");
}

TEST_CASE("answers are written and read as dimod does, packed and unpacked") {
  SampleSet answer;
  answer.vartype = Vartype::spin;
  answer.labels = {std::int64_t(0), std::int64_t(1), std::int64_t(2)};
  answer.values = {-1, 1, -1};
  answer.energies = {-0.5};
  answer.occurrences = {1};
  CHECK(to_dimod_json(answer) == kAnswer);
  CHECK(samples_from_dimod_json(kAnswer, "a.json") == answer);
  const std::string unpacked = to_dimod_json(answer, false);
  CHECK(
      unpacked.find(
          R"("sample_data":{"type":"array","data":[[-1,1,-1]],"data_type":"int8","shape":[1,3],"use_bytes":false},"sample_type":"int8","sample_packed":false)") !=
      std::string::npos);
  CHECK(samples_from_dimod_json(unpacked, "u.json") == answer);

  SampleSet wide;
  for (std::int64_t i = 0; i < 33; ++i) wide.labels.emplace_back(i);
  wide.values.assign(33, 1);
  wide.energies = {3};
  wide.occurrences = {2};
  CHECK(to_dimod_json(wide).find(R"("data":[[4294967295,1]],"data_type":"uint32","shape":[1,2])") != std::string::npos);
  CHECK(to_dimod_json(wide).find(R"("energy":{"type":"array","data":[3])") != std::string::npos);
  CHECK(samples_from_dimod_json(to_dimod_json(wide), "w.json") == wide);

  SampleSet two;
  two.labels = {"x", "y"};
  two.values = {0, 1, 1, 0};
  two.energies = {0, 0};
  two.occurrences = {1, 1};
  CHECK(to_dimod_json(two).find(R"("data":[[2],[1]],"data_type":"uint32","shape":[2,1])") != std::string::npos);
}

TEST_CASE("damaged answers are refused with the place") {
  const auto refused = [](const std::string& from, const std::string& to) {
    CAPTURE(from, to);
    CHECK_THROWS_AS(samples_from_dimod_json(replaced(kAnswer, from, to), "a.json"), InputError);
  };
  refused("[[2]]", "[[2,0]]");
  refused("[[2]]", "[[2],[2]]");
  refused("[[2]]", "[[-1]]");
  refused("[[2]]", "[[4294967296]]");
  refused("[[2]]", "[2]");
  refused("[-0.5]", "[null]");
  refused("[-0.5]", "[-0.5,1]");
  refused(R"("data":[1],"data_type":"int64")", R"("data":[0],"data_type":"int64")");
  refused(R"("num_rows":1)", R"("num_rows":2)");
  refused(R"("num_variables":3)", R"("num_variables":4)");
  refused(R"("num_variables":3)", R"("num_variables":99999999999)");
  refused(R"("sample_packed":true)", R"("sample_packed":false)");
  refused(R"("variable_type":"SPIN")", R"("variable_type":"spin")");
  refused(R"("info":{}})", R"("info":{}}{})");
}

TEST_CASE("an answer is taken only for its own problem") {
  const Problem problem = ring();
  SampleSet answer = make_sampler("exact")->sample(problem, {.reads = 20, .seed = 3});
  CHECK(check_answer(problem, answer, "answer") == answer);

  SECTION("columns in another order and the other vartype are put right") {
    SampleSet turned = answer;
    turned.vartype = Vartype::spin;
    turned.labels = {"d", "c", "b", "a"};
    for (std::size_t r = 0; r < 20; ++r)
      for (std::size_t i = 0; i < 4; ++i) turned.values[r * 4 + i] = answer.row(r)[3 - i] ? 1 : -1;
    CHECK(check_answer(problem, turned, "answer") == answer);
  }
  SECTION("energies of another problem") {
    Problem other = problem;
    other.linear[2] += 0.01;
    CHECK_THROWS_AS(check_answer(other, answer, "answer"), InputError);
  }
  SECTION("other labels") {
    answer.labels[1] = "z";
    CHECK_THROWS_AS(check_answer(problem, answer, "answer"), InputError);
  }
  SECTION("another hash, although labels and energies fit") {
    answer.info["problem_hash"] = "0123";
    CHECK_THROWS_AS(check_answer(problem, answer, "answer"), InputError);
    answer.info["problem_hash"] = problem_hash(problem);
    CHECK_NOTHROW(check_answer(problem, answer, "answer"));
  }
}
