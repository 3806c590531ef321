#include "learning/qubo/sapi.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "learning/qubo/bytes.h"
#include "learning/qubo/entries.h"
#include "learning/qubo/json_reader.h"
#include "learning/qubo/python_json.h"

namespace gonogo::learning {
namespace {

using Pair = std::pair<std::int64_t, std::int64_t>;

Pair ordered(std::int64_t a, std::int64_t b) { return {std::min(a, b), std::max(a, b)}; }

/// Position of each qubit of the problem; the labels must be qubits of the solver.
std::map<std::int64_t, std::size_t> active_qubits(const Problem& problem, const SapiSolver& solver) {
  std::vector<std::int64_t> working = solver.qubits;
  std::sort(working.begin(), working.end());
  std::map<std::int64_t, std::size_t> active;
  for (std::size_t i = 0; i < problem.variable_count(); ++i) {
    const auto* qubit = std::get_if<std::int64_t>(&problem.labels[i]);
    if (!qubit || !std::binary_search(working.begin(), working.end(), *qubit))
      throw InputError("solver " + solver.name + ": variable " + label_text(problem.labels[i]) +
                       " is not one of its working qubits; embed the problem first");
    active[*qubit] = i;
  }
  return active;
}

std::vector<double> encode_quadratic(const Problem& problem, const SapiSolver& solver,
                                     const std::map<std::int64_t, std::size_t>& active) {
  std::map<Pair, double> value;
  for (const Coupling& c : problem.couplings)
    value[ordered(std::get<std::int64_t>(problem.labels[c.a]), std::get<std::int64_t>(problem.labels[c.b]))] = c.value;
  std::vector<double> quad;
  for (const auto& [a, b] : solver.couplers) {
    if (!active.count(a) || !active.count(b)) continue;
    const auto found = value.find(ordered(a, b));
    quad.push_back(found == value.end() ? 0.0 : found->second);
    if (found != value.end()) value.erase(found);
  }
  if (!value.empty())
    throw InputError("solver " + solver.name + ": qubits " + std::to_string(value.begin()->first.first) + " and " +
                     std::to_string(value.begin()->first.second) + " have no coupler; embed the problem first");
  return quad;
}

Json data_json(const Problem& problem, const SapiSolver& solver) {
  const auto active = active_qubits(problem, solver);
  std::vector<double> lin;
  for (std::int64_t qubit : solver.qubits) {
    const auto found = active.find(qubit);
    lin.push_back(found == active.end() ? std::numeric_limits<double>::quiet_NaN() : problem.linear[found->second]);
  }
  Json data;
  data["format"] = "qp";
  data["lin"] = base64(bytes_of(lin));
  data["quad"] = base64(bytes_of(encode_quadratic(problem, solver, active)));
  data["offset"] = problem.offset;
  return data;
}

/// The one problem of a submission, given as a list of one or bare.
const Json& only_problem(const Json& json, const std::string& source) {
  if (!json.is_array()) return json;
  if (json.items().size() != 1)
    throw InputError(source + ": " + std::to_string(json.items().size()) + " problems in the list; give one");
  return json.items().front();
}

void check_solver(const JsonReader& body, const SapiSolver& solver) {
  const JsonReader given = body.object("solver");
  if (given.text("name") != solver.name)
    given.fail("name",
               "the problem is for \"" + given.text("name") + "\", the solver given is \"" + solver.name + "\"");
  if (!given.find("version") || solver.graph_id.empty()) return;
  const std::string graph = given.object("version").text("graph_id");
  if (graph != solver.graph_id)
    given.fail("version.graph_id",
               "\"" + graph + "\" is not the working graph \"" + solver.graph_id + "\" of the solver");
}

}  // namespace

SapiSolver solver_from_json(const Json& json, const std::string& source) {
  const JsonReader reader(json, source, ""), properties = reader.object("properties");
  SapiSolver solver;
  if (reader.find("identity")) {
    const JsonReader identity = reader.object("identity");
    solver.name = identity.text("name");
    if (identity.find("version")) solver.graph_id = identity.object("version").text("graph_id");
  } else {
    solver.name = reader.text("id");
  }
  solver.chip_size = properties.integer("num_qubits", 1, kMaxVariables);
  solver.qubits = properties.integers("qubits", 0, solver.chip_size - 1);
  std::vector<std::int64_t> sorted = solver.qubits;
  std::sort(sorted.begin(), sorted.end());
  if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end())
    properties.fail("qubits", "a qubit is listed twice");
  std::vector<Pair> seen;
  for (const Json& item : properties.list("couplers")) {
    if (!item.is_array() || item.items().size() != 2) properties.fail("couplers", "expected pairs of qubits");
    const std::int64_t a = properties.as_integer(item.items()[0], "couplers", 0, solver.chip_size - 1);
    const std::int64_t b = properties.as_integer(item.items()[1], "couplers", 0, solver.chip_size - 1);
    if (a == b || !std::binary_search(sorted.begin(), sorted.end(), a) ||
        !std::binary_search(sorted.begin(), sorted.end(), b))
      properties.fail("couplers", item.dump() + " does not join two listed qubits");
    solver.couplers.emplace_back(a, b);
    seen.push_back(ordered(a, b));
  }
  std::sort(seen.begin(), seen.end());
  if (std::adjacent_find(seen.begin(), seen.end()) != seen.end()) properties.fail("couplers", "a pair is listed twice");
  return solver;
}

std::string to_sapi(const Problem& problem, const SapiSolver& solver, const SapiSettings& settings) {
  check_problem(problem, "problem");
  Json body;
  body["solver"]["name"] = solver.name;
  if (!solver.graph_id.empty()) body["solver"]["version"]["graph_id"] = solver.graph_id;
  body["data"] = data_json(problem, solver);
  body["type"] = problem.vartype == Vartype::spin ? "ising" : "qubo";
  body["params"] = settings.params;
  if (!settings.label.empty()) body["label"] = settings.label;
  return python_json(Json(Json::Array{body}), JsonSpaces::after) + "\n";
}

Problem problem_from_sapi(const std::string& text, const SapiSolver& solver, const std::string& source) {
  const Json json = Json::parse(text, source);
  const JsonReader body(only_problem(json, source), source, ""), data = body.object("data");
  check_solver(body, solver);
  data.expect_text("format", "qp");
  const std::string type = body.text("type");
  if (type != "ising" && type != "qubo") body.fail("type", "expected \"ising\" or \"qubo\", found \"" + type + "\"");
  const auto lin = numbers_from_base64<double>(data.text("lin"), source + ": data.lin");
  const auto quad = numbers_from_base64<double>(data.text("quad"), source + ": data.quad");
  data.expect_size("lin", lin.size(), solver.qubits.size());
  std::vector<Entry> entries;
  std::map<std::int64_t, bool> active;
  for (std::size_t k = 0; k < lin.size(); ++k) {
    active[solver.qubits[k]] = !std::isnan(lin[k]);
    if (!std::isnan(lin[k])) entries.push_back({solver.qubits[k], solver.qubits[k], lin[k]});
  }
  std::size_t used = 0;
  for (const auto& [a, b] : solver.couplers) {
    if (!active[a] || !active[b]) continue;
    if (used < quad.size()) entries.push_back({a, b, quad[used]});
    ++used;
  }
  data.expect_size("quad", quad.size(), used);
  Problem problem =
      problem_from_entries(type == "ising" ? Vartype::spin : Vartype::binary, {}, entries, Repeats::refuse, source);
  problem.offset = data.find("offset") ? data.number("offset") : 0;
  check_problem(problem, source);
  return problem;
}

}  // namespace gonogo::learning
