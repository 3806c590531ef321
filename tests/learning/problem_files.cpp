// Files of problems, byte for byte against what the programs they belong to write.
#include <cmath>
#include <cstring>

#include "base/files/file.h"
#include "base/math/random.h"
#include "learning/formats/dimod.h"
#include "learning/formats/format.h"
#include "learning/qubo/text.h"
#include "tests/support/catch.h"
#include "tests/support/md5.h"
#include "tests/support/message.h"
#include "tests/support/refused.h"

using namespace gonogo;
using namespace gonogo::learning;

namespace {

std::string written_as(const char* format, const Problem& problem) { return format_named(format).write(problem, {}); }
Problem read_as(const char* format, const std::string& text, const std::string& source) {
  return format_named(format).read(text, {}, source);
}
std::string to_coo(const Problem& problem) { return written_as("coo", problem); }
Problem problem_from_coo(const std::string& text, std::optional<Vartype> vartype, const std::string& source) {
  return format_named("coo").read(text, {.solver = nullptr, .sapi = {}, .vartype = vartype}, source);
}
std::string to_qbsolv(const Problem& problem) { return written_as("qbsolv", problem); }
Problem problem_from_qbsolv(const std::string& text, const std::string& source) {
  return read_as("qbsolv", text, source);
}
std::string to_bqpjson(const Problem& problem) { return written_as("bqpjson", problem); }
Problem problem_from_bqpjson(const std::string& text, const std::string& source) {
  return read_as("bqpjson", text, source);
}
std::string to_bqm_file(const Problem& problem, int version = 2) {
  return written_as(version == 1 ? "dimod_bqm_v1" : "dimod_bqm", problem);
}
Problem problem_from_bqm_file(const std::string& text, const std::string& source) {
  return read_as("dimod_bqm", text, source);
}

Problem chain_of_three() {
  Problem problem;
  problem.vartype = Vartype::spin;
  for (std::int64_t i = 0; i < 3; ++i) problem.labels.emplace_back(i);
  problem.linear = {0.5, -0.25, 0};
  problem.couplings = {{0, 1, -1}, {1, 2, 0.75}};
  problem.offset = 0.125;
  return problem;
}

Problem product() {
  Problem problem;
  problem.labels = {"x", "y"};
  problem.linear = {0, 0};
  problem.couplings = {{0, 1, -1}};
  return problem;
}

/// Labels and numbers that are hard to write.
Problem odd() {
  Problem problem;
  problem.labels = {std::int64_t(3), "na\u00efve\n\"q\"", std::int64_t(-7), "\U0001F701"};
  problem.linear = {1.0 / 3, 1e15, 1e-7, 5e-324};
  problem.couplings = {{0, 2, 1e16}, {0, 3, -2.5}, {2, 3, 0.0}};
  problem.offset = 123456789012345678.0;
  return problem;
}

Problem random_problem(std::size_t n, Vartype vartype, std::uint64_t seed) {
  Problem problem;
  problem.vartype = vartype;
  for (std::uint32_t i = 0; i < n; ++i) {
    problem.labels.emplace_back("u" + std::to_string(i));
    problem.linear.push_back(random_unit(seed, 0, i) - 0.5);
    for (std::uint32_t j = i + 1; j < n; ++j)
      if (random_unit(seed, i + 1, j) < 0.4)
        problem.couplings.push_back({i, j, 3 * random_unit(seed, i + 1, 100 + j) - 1});
  }
  problem.linear.back() = 0;
  problem.offset = 0.1;
  return problem;
}

double lowest_energy(const Problem& problem, std::string* state = nullptr) {
  double lowest = INFINITY;
  for (std::size_t bits = 0; bits < std::size_t(1) << problem.variable_count(); ++bits) {
    std::vector<std::int8_t> row;
    for (std::size_t i = 0; i < problem.variable_count(); ++i)
      row.push_back(bits >> i & 1 ? 1 : problem.vartype == Vartype::binary ? 0 : -1);
    if (energy(problem, row) >= lowest) continue;
    lowest = energy(problem, row);
    if (state) {
      state->clear();
      for (std::int8_t value : row) *state += value > 0 ? '1' : '0';
    }
  }
  return lowest;
}

template <class T>
std::string with(std::string bytes, std::size_t at, T value) {
  std::memcpy(bytes.data() + at, &value, sizeof value);
  return bytes;
}

std::string with_text(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

}  // namespace

TEST_CASE("md5 of the RFC's own examples") {
  CHECK(md5("") == "d41d8cd98f00b204e9800998ecf8427e");
  CHECK(md5("abc") == "900150983cd24fb0d6963f7d28e17f72");
  CHECK(md5("12345678901234567890123456789012345678901234567890123456789012345678901234567890") ==
        "57edf4a22be3c955ac49da2e2107b67a");
}

TEST_CASE("dimod's binary files have dimod's bytes") {
  // sums of the first from D-Wave's documentation of uploads, of the others from dimod 0.12.23
  CHECK(md5(to_bqm_file(product())) == "9a40e21eec39c590f7a1c6128a41389f");
  CHECK(to_bqm_file(product()).size() == 312);
  CHECK(md5(to_bqm_file(chain_of_three())) == "779c5427db067b831426919004424dc3");
  CHECK(md5(to_bqm_file(chain_of_three(), 1)) == "5aebcd38005ba45cec65866e213aefb2");
  Problem empty;
  empty.vartype = Vartype::spin;
  CHECK(md5(to_bqm_file(empty)) == "dcf969c75b0334876d5e79d620ad21d5");
  Problem slope;
  slope.labels = {"slope"};
  slope.linear = {1.5};
  slope.offset = -2;
  CHECK(md5(to_bqm_file(slope)) == "fd3f1f54b372dfdade782e92409bfbac");
  CHECK(md5(to_bqm_file(slope, 1)) == "1622904f198b1fda6de890761ad65c9d");
  CHECK(md5(to_bqm_file(odd())) == "09f7616d0766dc8e4e0f1ba1833e9e34");
  CHECK(md5(to_bqm_file(odd(), 1)) == "e3727c9bc81073ccbe24d9a3c20420ed");
  for (const Problem& problem : {product(), chain_of_three(), empty, slope, odd()})
    for (int version : {1, 2}) CHECK(problem_from_bqm_file(to_bqm_file(problem, version), "p.bqm") == problem);
}

TEST_CASE("a single-precision file of dimod is read") {
  const std::string file = from_base64(
      "RElNT0RCUU0CALIAAAB7ImR0eXBlIjogImZsb2F0MzIiLCAiaXR5cGUiOiAiaW50MzIiLCAibnR5cGUiOiAiaW50MzIiLCAic2hhcGUiOiBbMywg"
      "Ml0sICJ0eXBlIjogIkJpbmFyeVF1YWRyYXRpY01vZGVsIiwgInZhcmlhYmxlcyI6IGZhbHNlLCAidmFydHlwZSI6ICJTUElOIn0KICAgICAgICAg"
      "ICAgICAgICAgICAgICAgICAgICAgICAgAAAAPgAAAAAAAAA/AQAAAAAAgL4DAAAAAAAAAAEAAAAAAIC/"
      "AAAAAAAAgL8CAAAAAABAPwEAAAAAAEA/",
      "golden");
  CHECK(problem_from_bqm_file(file, "f32.bqm") == chain_of_three());
}

TEST_CASE("odd numbers and labels in dimod's JSON") {
  const std::string text = to_dimod_json(odd());
  CHECK(md5(text) == "68afe3fe1dfcd10e4ff37c9aaa30936d");
  CHECK(problem_from_dimod_json(text, "odd.json") == odd());
}

TEST_CASE("damaged binary files are refused with the reason") {
  const std::string good = to_bqm_file(chain_of_three());  // header 192 bytes, offset, 3 starts and biases, neighbours
  const auto read = [](const std::string& bytes) { return [bytes] { problem_from_bqm_file(bytes, "p.bqm"); }; };
  CHECK_NOTHROW(read(good)());
  refused(read("DIMODBQ"), "DIMODBQM");
  refused(read(with<char>(good, 8, 3)), "version 3.0");
  for (std::size_t cut = 8; cut < good.size(); cut += 7) refused(read(good.substr(0, cut)), "p.bqm");
  refused(read(good + " "), "after the end");
  refused(read(with<std::uint32_t>(good, 10, 0xFFFFFFFFu)), "header");
  refused(read(with_text(good, "[3, 2]", "[3,-2]")), "shape");
  refused(read(with_text(good, "[3, 2]", "[9, 2]")), "bytes");
  refused(
      read(with_text(good, "[3, 2], \"type\": \"BinaryQuadraticModel\"", "[2000000000, 2], \"type\": \"BinaryQuadr\"")),
      "p.bqm");
  refused(read(with_text(good, "\"SPIN\"", "\"SPON\"")), "vartype");
  refused(read(with_text(good, "float64", "float16")), "dtype");
  refused(read(with_text(good, "\"int32\"", "\"int16\"")), "type");
  refused(read(with<double>(good, 192, NAN)), "finite");
  refused(read(with<double>(good, 192 + 8 + 4, INFINITY)), "finite");
  refused(read(with<std::int32_t>(good, 200, 1)), "starts");
  refused(read(with<std::int32_t>(good, 212, 7)), "starts");
  refused(read(with<std::int32_t>(good, 236, 2)), "do not agree");
  refused(read(with<std::int32_t>(good, 236, -1)), "neighbour");
  refused(read(with<double>(good, 240, 4.0)), "do not agree");
  const std::string labelled = to_bqm_file(product());
  refused(read(labelled.substr(0, labelled.size() - 64)), "labels");
  refused(read(with_text(labelled, "\"y\"", "\"x\"")), "twice");
  refused(read(with_text(labelled, "[\"x\", \"y\"]", "[\"x\", null]")), "VARS");
  refused(read(with_text(labelled, "VARS", "VARZ")), "VARS");
}

TEST_CASE("coordinate text is dimod's, and never loses digits or needs an exponent") {
  Problem problem;
  for (std::int64_t i = 0; i < 3; ++i) problem.labels.emplace_back(i);
  problem.linear = {-1, 0, 0};
  problem.couplings = {{0, 1, 1}, {1, 2, -4.5}};
  const std::string text = "# vartype=BINARY\n# 3 coefficients\n0 0 -1.000000\n0 1 1.000000\n1 2 -4.500000\n";
  CHECK(to_coo(problem) == text);
  CHECK(problem_from_coo(text, {}, "p.coo") == problem);
  problem.linear = {1e-7, 1.0 / 3, 1e22};
  const std::string small = to_coo(problem);
  CHECK(small.find("0 0 0.0000001\n") != std::string::npos);
  CHECK(small.find('e', small.find("coefficients\n") + 12) == std::string::npos);
  CHECK(problem_from_coo(small, Vartype::binary, "p.coo") == problem);
}

TEST_CASE("coordinate text: repeats add up, damage is refused") {
  const Problem problem = problem_from_coo("# x vartype: SPIN\n\n3 3 1\n5 3 2\n3 5 0.5\n3 3 1e-1\n", {}, "p.coo");
  CHECK(problem.vartype == Vartype::spin);
  CHECK(problem.labels == std::vector<Label>{std::int64_t(3), std::int64_t(5)});
  CHECK(problem.linear == std::vector<double>{1.1, 0});
  CHECK(problem.couplings == std::vector<Coupling>{{0, 1, 2.5}});
  const auto read = [](const std::string& text) { return [text] { problem_from_coo(text, {}, "p.coo"); }; };
  refused(read("0 1 1\n"), "vartype");
  refused(read("# vartype=BINARY\n0 1\n"), "line 2");
  refused(read("# vartype=BINARY\n0 1 1 1\n"), "line 2");
  refused(read("# vartype=BINARY\n0 -1 1\n"), "line 2");
  refused(read("# vartype=BINARY\n0 1 nan\n"), "finite");
  refused(read("# vartype=BINARY\n0 1 1e999\n"), "finite");
  refused(read("# vartype=BINARY\n0 1 1.0x\n"), "finite");
  refused(read("# vartype=BINARY\n# vartype=SPIN\n"), "contradicts");
  refused(read("# vartype=DISCRETE\n"), "DISCRETE");
}

TEST_CASE("coordinate text that was cut off anywhere is refused, but for ends of lines in files without a count") {
  const std::string ours = to_coo(random_problem(6, Vartype::binary, 8));
  const auto read = [](const std::string& text) { problem_from_coo(text, {}, "p.coo"); };
  read(ours);
  for (std::size_t size = ours.find("coefficients") + 12; size < ours.size(); ++size) {
    INFO("the first " << size << " of " << ours.size() << " bytes");
    CHECK_THROWS_AS(read(ours.substr(0, size)), InputError);
  }
  refused([&] { read(ours + "0 1 0.5\n"); }, "its header states");
  const std::string dimods = "# vartype=BINARY\n0 0 -1.000000\n0 1 1.000000\n1 2 -4.500000";
  read(dimods);
  for (std::size_t cut = 1; cut < 7; ++cut) refused([&] { read(dimods.substr(0, dimods.size() - cut)); }, "cut off");
}

TEST_CASE("qbsolv's own example has the optimum its README names") {
  const std::string text =
      "c example\np qubo 0 4 4 6\n0 0 3.4\n1 1 4.5\n2 2 2.1\n3 3 -2.4\n0 1 2.2\n0 2 3.4\n1 2 4.5\n0 3 -2\n1 3 4.5678\n"
      "2 3 -3.22\n";
  const Problem problem = problem_from_qbsolv(text, "p.qubo");
  std::string state;
  CHECK(lowest_energy(problem, &state) == Approx(-3.52).margin(1e-12));
  CHECK(state == "0011");
  CHECK(problem_from_qbsolv(to_qbsolv(problem), "p.qubo") == problem);
  CHECK(to_qbsolv(Problem{}) ==
        "c id : 0\nc \nc scale : 1.0\nc offset : 0.0\nc \np qubo 0 0 0 0\nc linear terms\nc quadratic terms\n");
  CHECK(problem_from_qbsolv("p qubo 0 0 0 0\n", "p.qubo") == Problem{});
  const SampleSet answer = answer_format_named("qbsolv").read_answer(
      "4 bits, find Min, SubMatrix= 47, -a o, timeout=2592000.0 sec\n0011\n-3.52000 Energy of solution\n"
      "0 Number of Partitioned calls, 1 output sample\n 0.00062 seconds of classic cpu time",
      problem, "a.txt");
  CHECK(check_answer(problem, answer, "a.txt").values == std::vector<std::int8_t>{0, 0, 1, 1});
}

TEST_CASE("qbsolv text with wrong counts, order or repeats is refused") {
  const auto read = [](const std::string& text) { return [text] { problem_from_qbsolv(text, "p.qubo"); }; };
  refused(read("p qubo 0 2 2 1\n0 0 1\n1 0 2.0\n1 1 1\n"), "smaller comes first");
  refused(read("p qubo 0 2 2 1\n0 0 1\n1 1 2.0\n"), "declared");
  refused(read("p qubo 0 2 1 1\n0 0 1\n0 2 1\n"), "line 3");
  refused(read("p qubo 0 2 1 2\n0 0 1\n0 1 1\n0 1 1\n"), "twice");
  refused(read("p qubo 3 2 1 1\n"), "topology");
  refused(read("0 0 1\n"), "before");
  refused(read("c only\n"), "p qubo");
  refused(read("p qubo 0 9999999999 1 1\n"), "whole number");
  refused(read("p qubo 0 1 1 0\n0 0 inf\n"), "finite");
  CHECK(problem_from_qbsolv("c offset : 2.5\nc scale : 2.0\np qubo 0 1 1 0\n0 0 1.5\n", "p.qubo").offset == 5);
}

TEST_CASE("bqpjson as Python writes it, and its own example") {
  Problem problem;
  problem.labels = {std::int64_t(2), std::int64_t(6)};
  problem.linear = {1.3, -0.7};
  CHECK(
      to_bqpjson(problem) ==
      R"({"id": 0, "linear_terms": [{"coeff": 1.3, "id": 2}, {"coeff": -0.7, "id": 6}], "metadata": {}, "offset": 0.0, "quadratic_terms": [], "scale": 1.0, "variable_domain": "boolean", "variable_ids": [2, 6], "version": "1.0.0"})"
      "\n");
  CHECK(to_qbsolv(problem).find("p qubo 0 7 2 0\nc linear terms\n2 2 1.3\n6 6 -0.7\n") != std::string::npos);
  CHECK(problem_from_bqpjson(to_bqpjson(chain_of_three()), "p") == chain_of_three());
  const std::string scaled = with_text(to_bqpjson(chain_of_three()), "\"scale\": 1.0", "\"scale\": 2.0");
  CHECK(problem_from_bqpjson(scaled, "p").couplings[1].value == 1.5);
  CHECK(problem_from_bqpjson(scaled, "p").offset == 0.25);
}

TEST_CASE("bqpjson that its own validator would refuse is refused") {
  const std::string good = to_bqpjson(chain_of_three());
  const auto changed = [&](const std::string& from, const std::string& to) {
    return [text = with_text(good, from, to)] { problem_from_bqpjson(text, "p.bqpjson"); };
  };
  refused(changed("\"1.0.0\"", "\"0.9.0\""), "version");
  refused(changed("\"spin\"", "\"potts\""), "variable_domain");
  refused(changed("\"scale\": 1.0", "\"scale\": -1.0"), "scale");
  refused(changed("\"id\": 1}", "\"id\": 0}"), "twice");
  refused(changed("\"id\": 1}", "\"id\": 9}"), "variable_ids");
  refused(changed("\"id_head\": 1, \"id_tail\": 0", "\"id_head\": 0, \"id_tail\": 0"), "itself");
  refused(changed("\"id_head\": 2, \"id_tail\": 1", "\"id_head\": 1, \"id_tail\": 0"), "twice");
  refused(changed("[0, 1, 2]", "[0, 1, 1]"), "variable_ids");
  refused(changed("0.75", "1e999"), "large");
  refused(changed("\"offset\": 0.125, ", ""), "offset");
}

TEST_CASE("the three meanings of \"n m\" differ by sign and the factor 2") {
  const std::string sample = "3 5\n1 1 5\n2 2 3\n3 3 1\n1 2 -6\n2 3 -1\n";
  // MQLib's own sample: its largest value is 6, at 1 0 1
  std::string state;
  const Problem mqlib = read_as("mqlib", sample, "s");
  CHECK(lowest_energy(mqlib, &state) == -6);
  CHECK(state == "101");
  // as Biq Mac: x'Qx with symmetric Q, least at 1 1 1: 5 + 3 + 1 - 2 * 6 - 2 * 1
  const Problem biq_mac = read_as("biq_mac", sample, "s");
  CHECK(lowest_energy(biq_mac, &state) == -5);
  CHECK(state == "111");
  CHECK(written_as("mqlib", mqlib) == "3 5\n1 1 5\n1 2 -6\n2 2 3\n2 3 -1\n3 3 1\n");
  CHECK(read_as("biq_mac", written_as("biq_mac", biq_mac), "s") == biq_mac);
  // a 5-cycle with unit weights: its largest cut is 4 of 5 edges; E = W - 2 cut
  const Problem cycle = read_as("rudy", "5 5\n1 2 1\n2 3 1\n3 4 1\n4 5 1\n5 1 1\n", "c5");
  CHECK(cycle.vartype == Vartype::spin);
  CHECK(lowest_energy(cycle) == 5 - 2 * 4);
  CHECK(written_as("rudy", cycle) == "5 5\n1 2 1\n1 5 1\n2 3 1\n3 4 1\n4 5 1\n");
}

TEST_CASE("damaged \"n m\" files are refused") {
  const auto read = [](const std::string& text, const char* dialect = "biq_mac") {
    return [=] { read_as(dialect, text, "p.txt"); };
  };
  refused(read(""), "no line");
  refused(read("3 2\n1 2 1\n"), "declared");
  refused(read("3 1\n1 4 1\n"), "line 2");
  refused(read("3 1\n0 1 1\n"), "line 2");
  refused(read("3 2\n1 2 1\n2 1 1\n"), "twice");
  refused(read("99999999999 1\n1 2 1\n"), "whole number");
  refused(read("3 1\n1 1 1\n", "rudy"), "itself");
  Problem field = chain_of_three();
  refused([&] { written_as("rudy", field); }, "linear");
}

TEST_CASE("every format with its sidecar gives the exported problem back, to the last bit") {
  const auto vartype = GENERATE(Vartype::binary, Vartype::spin);
  const Problem problem = random_problem(9, vartype, 4);
  for (const Format* choice : problem_formats()) {
    const Format& format = *choice;
    const std::string name = format.name;
    if (name == "sapi") continue;
    Problem given = problem;
    if (name == "rudy") {
      given = to_ising(given);
      given.linear.assign(9, 0.0);
    }
    CAPTURE(name);
    const WrittenProblem written = write_problem(given, format);
    const ProblemSidecar sidecar =
        sidecar_from_json(Config::parse(to_json(sidecar_of(written, format)).dump(), "p.sidecar.json"));
    const Problem back = restore(read_problem(written.text, format, {}, "p"), sidecar, "p");
    CHECK(back == written.problem);
    CHECK(problem_hash(back) == sidecar.problem_hash);
    for (int k = 0; k < 20; ++k) {  // the energies of the problem that was given
      std::vector<std::int8_t> from, to;
      for (std::uint64_t i = 0; i < 9; ++i) {
        const bool on = random_bits(7, std::uint64_t(k), i) & 1;
        from.push_back(on ? 1 : given.vartype == Vartype::binary ? 0 : -1);
        to.push_back(on ? 1 : back.vartype == Vartype::binary ? 0 : -1);
      }
      CHECK(energy(back, to) == Approx(energy(given, from)).margin(1e-12));
    }
    CHECK(written.notes.empty() == (format.labels && (vartype == Vartype::binary ? format.binary : format.spin)));
  }
}

TEST_CASE("a sidecar of another problem, or a changed file, is refused") {
  const Problem problem = random_problem(6, Vartype::binary, 8);
  const WrittenProblem written = write_problem(problem, format_named("coo"));
  ProblemSidecar sidecar = sidecar_of(written, format_named("coo"));
  const auto read = [&](const std::string& text) {
    return [&, text] { restore(read_problem(text, format_named("coo"), {}, "p.coo"), sidecar, "p.coo"); };
  };
  CHECK_NOTHROW(read(written.text)());
  const std::size_t count = written.text.find("# ", 2);
  const std::string uncounted = std::string(written.text).erase(count, written.text.find('\n', count) + 1 - count);
  refused(read(uncounted + "0 1 0.5\n"), "another problem");
  refused(read(uncounted + "7 7 0.5\n"), "does not know");
  refused(read(with_text(written.text, "BINARY", "SPIN")), "another problem");
  sidecar.offset = 3;
  refused(read(written.text), "another problem");
  const std::string json = to_json(sidecar).dump();
  const auto parse = [&](const std::string& from, const std::string& to) {
    return [text = with_text(json, from, to)] { sidecar_from_json(Config::parse(text, "s.sidecar.json")); };
  };
  refused(parse("\"beta\":1.0", "\"beta\":0.0"), "beta");
  refused(parse("sidecar/3", "sidecar/9"), "format");
  refused(parse("\"coo\"", "\"zoo\""), "problem_format");
  refused(parse("\"ids\":[0,", "\"ids\":["), "ids");
}

TEST_CASE("labels of every kind of dimod go through its files and tables and come back") {
  const std::string labels = R"j([[0, 1], [0, [1, "a"], 2], [0, 0, 1, 2], [], [[]], [1], 1.5, -0.25, 1e-07,)j"
                             R"j( "(0, 1)", "", "a,b", "\"q\"", 9223372036854775807, -9223372036854775808])j";
  Problem problem = problem_from_dimod_json(with_text(to_dimod_json(random_problem(15, Vartype::spin, 4)),
                                                      R"(["u0","u1","u2","u3","u4","u5","u6","u7",)"
                                                      R"("u8","u9","u10","u11","u12","u13","u14"])",
                                                      labels),
                                            "p.json");
  CHECK(label_text(problem.labels[0]) == "(0, 1)");
  CHECK(label_text(problem.labels[1]) == "(0, (1, 'a'), 2)");
  CHECK(label_text(problem.labels[5]) == "(1,)");
  CHECK(problem_from_bqm_file(to_bqm_file(problem, 2), "p.bqm") == problem);
  CHECK(problem_from_bqm_file(to_bqm_file(problem, 1), "p.bqm") == problem);
  CHECK(problem_from_dimod_json(to_dimod_json(problem), "p.json") == problem);
  CHECK(to_bqm_file(problem, 2).find(R"([[0, 1], [0, [1, "a"], 2], [0, 0, 1, 2], [], [[]], [1], 1.5, -0.25, 1e-07)") !=
        std::string::npos);

  problem.labels[9] = "t";  // a table cannot tell the text "(0, 1)" from the tuple
  SampleSet answer;
  answer.vartype = Vartype::spin;
  answer.labels = problem.labels;
  answer.values.assign(15, 1);
  answer.energies = {energy(problem, answer.values)};
  answer.occurrences = {2};
  CHECK(samples_from_dimod_json(to_dimod_json(answer), "a.json") == answer);
  CHECK(read_answer(samples_csv(answer), answer_format_named("csv"), problem, "a.csv") == answer);

  const auto with_label = [&](const std::string& label) {
    return [=] { problem_from_dimod_json(with_text(to_dimod_json(product()), R"("x")", label), "p.json"); };
  };
  refused(with_label("null"), "relabel");
  refused(with_label("[0, true]"), "relabel");
  refused(with_label("18446744073709551615"), "relabel");
}

TEST_CASE("files of neighbouring kinds are called by their names") {
  const auto read = [](const std::string& text) {
    return [=] { read_problem(text, format_named("dimod_json"), {}, "p.json"); };
  };
  refused(read("DIMODCQM\2"), "constrained quadratic model (CQM)");
  refused(read("DIMODDQM\1"), "discrete quadratic model (DQM)");
  refused(read("DIMODQM\1"), "quadratic model (QM)");
  refused(read(std::string("\x80\x04\x95\x00.", 5)), "pickle");
  refused(read("\\ a comment\nMinimize\n obj: + 1 x\nEnd\n"), "LP file");
  refused(read("PK\3\4..."), "ZIP");
  refused([] { read_answer("DIMODQM\1", answer_format_named("dimod_json"), product(), "a.json"); }, "quadratic model");
}

TEST_CASE("dimod's empty sample set is read, whatever width it gives") {
  const std::string text =
      R"({"type":"SampleSet","version":{"sampleset_schema":"3.2.0"},"num_variables":2,"num_rows":0,"sample_data":)"
      R"({"type":"array","data":[],"data_type":"uint32","shape":[0,2],"use_bytes":false},"sample_type":"int8",)"
      R"("sample_packed":true,"vectors":{"energy":{"type":"array","data":[],"data_type":"float64","shape":[0],)"
      R"("use_bytes":false},"num_occurrences":{"type":"array","data":[],"data_type":"int64","shape":[0],)"
      R"("use_bytes":false}},"variable_labels":["x","y"],"variable_type":"BINARY","info":{}})";
  CHECK(samples_from_dimod_json(text, "a.json").row_count() == 0);
}

TEST_CASE("answers as tables: labels and values are checked") {
  const Problem problem = random_problem(3, Vartype::spin, 1);
  const auto read = [&](const std::string& text) {
    return read_answer(text, answer_format_named("csv"), problem, "a.csv");
  };
  const SampleSet answer = read("u1,u0,u2,num_occurrences\n1,-1,1,3\n-1,-1,1,1\n");
  CHECK(answer.values == std::vector<std::int8_t>{-1, 1, 1, -1, -1, 1});
  CHECK(answer.occurrences == std::vector<std::int64_t>{3, 1});
  CHECK(answer.energies[0] == energy(problem, answer.row(0)));
  CHECK(read(samples_csv(answer)) == answer);
  refused([&] { read("u0,u1\n1,1\n"); }, "u2");
  refused([&] { read("u0,u1,u2,u3\n1,1,1,1\n"); }, "u3");
  refused([&] { read("u0,u1,u2\n1,1\n"); }, "line 2");
  refused([&] { read("u0,u1,u2\n1,1,0\n"); }, "line 2");
  refused([&] { read("u0,u1,u2\n1,1,\n"); }, "line 2");
  refused([&] { read("u0,u1,u2,num_occurrences\n1,1,1,0\n"); }, "num_occurrences");
}
