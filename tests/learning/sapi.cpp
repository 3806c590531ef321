// SAPI's problem and answer encodings against the unit tests and documentation of dwave-cloud-client.
#include "learning/formats/sapi.h"

#include <cmath>

#include "learning/formats/format.h"
#include "learning/qubo/text.h"
#include "tests/support/catch.h"
#include "tests/support/refused.h"

using namespace gonogo;
using namespace gonogo::learning;

namespace {

SapiSolver ring_of_four() {
  return solver_from_json(
      Json::parse(
          R"({"id":"ring","properties":{"num_qubits":4,"qubits":[0,1,2,3],"couplers":[[0,1],[1,2],[2,3],[3,0]]}})",
          "ring"),
      "ring");
}

Problem on_qubits(std::vector<std::int64_t> qubits, std::vector<double> h, std::vector<Coupling> J) {
  Problem problem;
  problem.vartype = Vartype::spin;
  problem.labels.assign(qubits.begin(), qubits.end());
  problem.linear = std::move(h);
  problem.couplings = std::move(J);
  return problem;
}

std::string member(const Problem& problem, const std::string& key) {
  return Json::parse(to_sapi(problem, ring_of_four(), {}), "p").items()[0].at("data").at(key).string();
}

std::string answer(const std::string& members) {
  return R"({"type":"ising","answer":{"format":"qp",)" + members + R"(,"timing":{}}})";
}

}  // namespace

TEST_CASE("problems on qubits have the bytes of the cloud client's own tests") {
  const Problem pair = on_qubits({0, 1}, {1, 1}, {{0, 1, -1}});
  CHECK(member(pair, "lin") == "AAAAAAAA8D8AAAAAAADwPwAAAAAAAPh/AAAAAAAA+H8=");
  CHECK(member(pair, "quad") == "AAAAAAAA8L8=");
  const Problem far = on_qubits({0, 3}, {0, 0}, {{0, 1, -1}});
  CHECK(member(far, "lin") == "AAAAAAAAAAAAAAAAAAD4fwAAAAAAAPh/AAAAAAAAAAA=");
  CHECK(member(far, "quad") == "AAAAAAAA8L8=");
  CHECK(member(on_qubits({0, 3}, {0, 0}, {}), "quad") == "AAAAAAAAAAA=");
  const Problem all = on_qubits({0, 1, 2, 3}, {1, 1, 1, 1}, {{0, 1, -1}, {0, 3, -1}, {1, 2, -1}, {2, 3, -1}});
  CHECK(member(all, "lin") == "AAAAAAAA8D8AAAAAAADwPwAAAAAAAPA/AAAAAAAA8D8=");
  CHECK(member(all, "quad") == "AAAAAAAA8L8AAAAAAADwvwAAAAAAAPC/AAAAAAAA8L8=");
  CHECK(member(on_qubits({0, 1}, {-0.5, 0.5}, {}), "lin").substr(0, 22) == "AAAAAAAA4L8AAAAAAADgPw");
}

TEST_CASE("a submitted problem is read back, with solver and parameters beside it") {
  SapiSolver solver = ring_of_four();
  solver.graph_id = "01d07086e1";
  Problem problem = on_qubits({0, 1, 3}, {0.5, 0, -1}, {{0, 1, 0.25}, {0, 2, 0}});
  problem.offset = 1.5;
  SapiSettings settings;
  settings.params["num_reads"] = 100;
  settings.params["auto_scale"] = false;
  settings.label = "a label";
  const std::string text = to_sapi(problem, solver, settings);
  CHECK(text.find(R"("solver": {"name": "ring", "version": {"graph_id": "01d07086e1"}})") != std::string::npos);
  CHECK(text.find(R"("type": "ising", "params": {"num_reads": 100, "auto_scale": false}, "label": "a label")") !=
        std::string::npos);
  CHECK(problem_from_sapi(text, solver, "p") == problem);
  const WrittenProblem written =
      write_problem(problem, format_named("sapi"), {.solver = &solver, .sapi = settings, .vartype = {}});
  CHECK(written.text == text);
  SapiSolver other = solver;
  other.graph_id = "ffff";
  refused([&] { problem_from_sapi(text, other, "p"); }, "graph_id");
  other.name = "disc";
  refused([&] { problem_from_sapi(text, other, "p"); }, "disc");
}

TEST_CASE("problems that a solver cannot hold, and damaged ones, are refused") {
  const SapiSolver solver = ring_of_four();
  const auto write = [&](const Problem& problem) { return [&, problem] { to_sapi(problem, solver, {}); }; };
  refused(write(on_qubits({0, 4}, {0, 0}, {})), "4");
  refused(write(on_qubits({0, 2}, {0, 0}, {{0, 1, 1}})), "no coupler");
  Problem named = on_qubits({0}, {0}, {});
  named.labels = {"slope"};
  refused(write(named), "embed");
  const auto read = [&](const std::string& lin, const std::string& quad) {
    return [&, lin, quad] {
      problem_from_sapi(R"({"solver":{"name":"ring"},"type":"ising","data":{"format":"qp","lin":")" + lin +
                            R"(","quad":")" + quad + R"("}})",
                        solver, "p");
    };
  };
  const std::string lin = "AAAAAAAA8D8AAAAAAADwPwAAAAAAAPh/AAAAAAAA+H8=", quad = "AAAAAAAA8L8=";
  CHECK_NOTHROW(read(lin, quad)());
  refused(read(lin.substr(4), quad), "lin");
  refused(read(lin.substr(0, 32), quad), "lin");
  refused(read(lin, ""), "quad");
  refused(read(lin, "AAAAAAAA8L8AAAAAAADwvw=="), "quad");
  refused(read(lin, "AAAAAAAA+H8="), "finite");
  refused(read(lin, "AAAA*AAA8L8="), "base64");
  const auto solver_text = [](const std::string& couplers) {
    return [couplers] {
      solver_from_json(
          Json::parse(R"({"id":"x","properties":{"num_qubits":3,"qubits":[0,2],"couplers":)" + couplers + "}}", "s"),
          "s.json");
    };
  };
  CHECK_NOTHROW(solver_text("[[0,2]]")());
  refused(solver_text("[[0,1]]"), "couplers");
  refused(solver_text("[[0,2],[2,0]]"), "twice");
  refused(solver_text("[[0,0]]"), "couplers");
}

TEST_CASE("answers are decoded as the cloud client decodes them") {
  const SampleSet down = samples_from_sapi(
      answer(
          R"("num_variables":5,"energies":"AAAAAAAALsA=","num_occurrences":"ZAAAAA==","active_variables":"AAAAAAEAAAACAAAAAwAAAAQAAAA=","solutions":"AAAAAA==")"),
      "a");
  CHECK(down.values == std::vector<std::int8_t>(5, -1));
  CHECK(down.energies == std::vector<double>{-15});
  CHECK(down.occurrences == std::vector<std::int64_t>{100});
  const SampleSet pair = samples_from_sapi(
      answer(
          R"("num_variables":5760,"energies":"AAAAAAAA8L8AAAAAAADwvw==","num_occurrences":"BgAAAAQAAAA=","active_variables":"HgAAAB8AAAA=","solutions":"AMA=")"),
      "a");
  CHECK(pair.labels == std::vector<Label>{std::int64_t(30), std::int64_t(31)});
  CHECK(pair.values == std::vector<std::int8_t>{-1, -1, 1, 1});
  CHECK(pair.occurrences == std::vector<std::int64_t>{6, 4});
}

TEST_CASE("ten variables take two bytes, the first variable in the highest bit") {
  SampleSet rows;
  rows.vartype = Vartype::spin;
  for (std::int64_t i = 0; i < 10; ++i) rows.labels.emplace_back(i);
  rows.values = {1, -1, 1, 1, -1, -1, -1, -1, 1, 1, -1, -1, -1, -1, -1, -1, -1, -1, -1, 1};
  rows.energies = {-2, -1};
  rows.occurrences = {1, 1};
  const std::string text = to_sapi_answer(rows, 16, true, Json::object());
  CHECK(Json::parse(text, "a").at("answer").at("solutions").string() == "sMAAQA==");
  CHECK(samples_from_sapi(text, "a") == rows);
  rows.occurrences = {3, 1};
  CHECK(samples_from_sapi(to_sapi_answer(rows, 16, true, Json::object()), "a") == rows);
  refused([&] { to_sapi_answer(rows, 16, false, Json::object()); }, "occurrences");
  refused([&] { to_sapi_answer(rows, 9, true, Json::object()); }, "qubit");
  rows.energies = {0, -1};
  refused([&] { to_sapi_answer(rows, 16, true, Json::object()); }, "ordered");
}

TEST_CASE("energies without the problem's offset, as SAPI serves them, are completed; others are left alone") {
  Problem problem;
  problem.vartype = Vartype::spin;
  problem.labels = {std::int64_t(30), std::int64_t(31)};
  problem.linear = {0.5, 0};
  problem.couplings = {{0, 1, -1}};
  problem.offset = 3;
  SampleSet rows;
  rows.vartype = Vartype::spin;
  rows.labels = problem.labels;
  rows.values = {-1, -1, 1, 1};
  rows.occurrences = {1, 1};
  for (double shift : {0.0, -3.0}) {
    rows.energies = {1.5 + shift, 2.5 + shift};
    const SampleSet found =
        read_answer(to_sapi_answer(rows, 64, true, Json::object()), answer_format_named("sapi"), problem, "a");
    CHECK(found.energies == std::vector<double>{1.5, 2.5});
  }
  rows.energies = {0.7, 2.5};  // neither: refused when checked
  CHECK_THROWS_AS(
      check_answer(
          problem,
          read_answer(to_sapi_answer(rows, 64, true, Json::object()), answer_format_named("sapi"), problem, "a"), "a"),
      InputError);
}

TEST_CASE("answers that do not fit together are refused") {
  const auto read = [](const std::string& members) {
    return [members] { samples_from_sapi(answer(members), "a.json"); };
  };
  const std::string head = R"("num_variables":64,"active_variables":"HgAAAB8AAAA=",)";
  const std::string two = R"("energies":"AAAAAAAA8L8AAAAAAADwvw==",)";
  CHECK_NOTHROW(read(head + two + R"("solutions":"AMA=")")());
  refused(read(head + two + R"("solutions":"AA==")"), "solutions");
  refused(read(head + two + R"("solutions":"AMAA")"), "solutions");
  refused(read(head + two + R"("num_occurrences":"BgAAAA==","solutions":"AMA=")"), "num_occurrences");
  refused(read(head + two + R"("num_occurrences":"BgAAAAAAAAA=","solutions":"AMA=")"), "counts start at 1");
  refused(read(head + R"("energies":"AAAAAAAA+H8AAAAAAADwvw==","solutions":"AMA=")"), "finite");
  refused(read(R"("num_variables":31,"active_variables":"HgAAAB8AAAA=",)" + two + R"("solutions":"AMA=")"),
          "active_variables");
  refused(read(R"("num_variables":64,"active_variables":"HwAAAB4AAAA=",)" + two + R"("solutions":"AMA=")"),
          "active_variables");
  refused([] { samples_from_sapi(R"({"status":"FAILED","error_message":"out of helium"})", "a"); }, "out of helium");
  refused([] { samples_from_sapi(R"({"error_code":400,"error_msg":"no such solver"})", "a"); }, "no such solver");
  refused([] { samples_from_sapi(R"({"status":"PENDING","type":"ising"})", "a"); }, "PENDING");
}
