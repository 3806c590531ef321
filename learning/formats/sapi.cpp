#include "learning/formats/sapi.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/error.h"
#include "base/format.h"
#include "learning/formats/format.h"
#include "learning/qubo/json.h"
#include "learning/qubo/text.h"

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

Json sapi_data(const Problem& problem, const SapiSolver& solver) {
  const auto active = active_qubits(problem, solver);
  std::vector<double> lin;
  for (std::int64_t qubit : solver.qubits) {
    const auto found = active.find(qubit);
    lin.push_back(found == active.end() ? std::numeric_limits<double>::quiet_NaN() : problem.linear[found->second]);
  }
  return Json::Object{{"format", "qp"},
                      {"lin", base64(bytes_of(lin))},
                      {"quad", base64(bytes_of(encode_quadratic(problem, solver, active)))},
                      {"offset", problem.offset}};
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
  body["data"] = sapi_data(problem, solver);
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

namespace {

/// Columns of the samples by ascending qubit.
std::vector<std::pair<std::int64_t, std::size_t>> qubit_columns(const SampleSet& samples, std::int64_t chip_size) {
  std::vector<std::pair<std::int64_t, std::size_t>> columns;
  for (std::size_t k = 0; k < samples.labels.size(); ++k) {
    const auto* qubit = std::get_if<std::int64_t>(&samples.labels[k]);
    if (!qubit || *qubit < 0 || *qubit >= chip_size)
      throw InputError("answer: variable " + label_text(samples.labels[k]) + " is not a qubit below " +
                       std::to_string(chip_size));
    columns.emplace_back(*qubit, k);
  }
  std::sort(columns.begin(), columns.end());
  return columns;
}

std::string pack_rows(const SampleSet& samples, const std::vector<std::pair<std::int64_t, std::size_t>>& columns) {
  const std::size_t width = (columns.size() + 7) / 8;
  std::string bytes(samples.row_count() * width, '\0');
  for (std::size_t r = 0; r < samples.row_count(); ++r)
    for (std::size_t k = 0; k < columns.size(); ++k)
      if (samples.row(r)[columns[k].second] > 0) bytes[r * width + k / 8] |= char(0x80 >> (k % 8));
  return bytes;
}

/// Bits of all rows; a decoder divides the bytes by the rows, so surplus bytes at the end of a row are allowed.
std::vector<std::int8_t> unpack_rows(const JsonReader& answer, const std::string& bytes, std::size_t rows,
                                     std::size_t variables, std::int8_t off) {
  if (rows == 0) {
    answer.expect_size("solutions", bytes.size(), 0);
    return {};
  }
  const std::size_t width = bytes.size() / rows;
  if (bytes.size() % rows != 0 || width < (variables + 7) / 8)
    answer.fail("solutions", std::to_string(bytes.size()) + " bytes cannot hold " + std::to_string(rows) + " rows of " +
                                 std::to_string(variables) + " bits");
  std::vector<std::int8_t> values;
  values.reserve(rows * variables);
  for (std::size_t r = 0; r < rows; ++r)
    for (std::size_t k = 0; k < variables; ++k)
      values.push_back((bytes[r * width + k / 8] >> (7 - k % 8)) & 1 ? 1 : off);
  return values;
}

void check_status(const JsonReader& reader) {
  if (reader.find("error_msg")) reader.fail("error_msg", reader.text("error_msg"));
  if (!reader.find("status")) return;
  const std::string status = reader.text("status");
  if (status == "COMPLETED") return;
  reader.fail("status", "the problem is " + status +
                            (reader.find("error_message") ? ": " + reader.text("error_message") : "") +
                            "; only the answer of a COMPLETED problem can be read");
}

std::vector<std::int64_t> read_counts(const JsonReader& answer, const std::string& where, std::size_t rows) {
  if (!answer.find("num_occurrences")) return std::vector<std::int64_t>(rows, 1);
  const auto counts = numbers_from_base64<std::int32_t>(answer.text("num_occurrences"), where + "num_occurrences");
  answer.expect_size("num_occurrences", counts.size(), rows);
  for (std::int32_t count : counts)
    if (count < 1) answer.fail("num_occurrences", "a count of " + std::to_string(count) + "; counts start at 1");
  return {counts.begin(), counts.end()};
}

/// SAPI serves energies without the problem's offset, which D-Wave's client adds on its side; saved answers may be of
/// either kind. The first row tells which; check_answer() verifies all.
SampleSet with_offset(SampleSet answer, const Problem& problem) {
  if (answer.row_count() == 0 || problem.offset == 0) return answer;
  std::map<Label, std::int8_t> value;
  for (std::size_t k = 0; k < answer.variable_count(); ++k) value[answer.labels[k]] = answer.row(0)[k];
  std::vector<std::int8_t> row;
  for (const Label& label : problem.labels) {
    const auto found = value.find(label);
    if (found == value.end()) return answer;  // another problem's: check_answer() says so
    row.push_back(found->second);
  }
  const double gap = energy(problem, row) - answer.energies.front();
  if (std::abs(gap - problem.offset) < std::abs(gap))
    for (double& e : answer.energies) e += problem.offset;
  return answer;
}

}  // namespace

std::string to_sapi_answer(const SampleSet& samples, std::int64_t chip_size, bool histogram, const Json& timing) {
  const auto columns = qubit_columns(samples, chip_size);
  if (histogram && !std::is_sorted(samples.energies.begin(), samples.energies.end()))
    throw InputError("answer: rows of a histogram answer must be ordered by energy");
  std::vector<std::int32_t> qubits, counts;
  for (const auto& column : columns) qubits.push_back(std::int32_t(column.first));
  for (std::int64_t count : samples.occurrences) {
    if (count < 1 || count > INT32_MAX || (!histogram && count != 1))
      throw InputError("answer: occurrences " + std::to_string(count) + " cannot be written in this answer mode");
    counts.push_back(std::int32_t(count));
  }
  Json json, answer;
  answer["format"] = "qp";
  answer["num_variables"] = Json(chip_size);
  answer["active_variables"] = base64(bytes_of(qubits));
  answer["energies"] = base64(bytes_of(samples.energies));
  if (histogram) answer["num_occurrences"] = base64(bytes_of(counts));
  answer["solutions"] = base64(pack_rows(samples, columns));
  answer["timing"] = timing;
  json["type"] = samples.vartype == Vartype::spin ? "ising" : "qubo";
  json["status"] = "COMPLETED";
  json["answer"] = std::move(answer);
  return python_json(json, JsonSpaces::after) + "\n";
}

SampleSet samples_from_sapi(const std::string& text, const std::string& source) {
  const Json json = Json::parse(text, source);
  const JsonReader reader(json, source, "");
  check_status(reader);
  const std::string type = reader.text("type"), where = source + ": answer.";
  if (type != "ising" && type != "qubo") reader.fail("type", "expected \"ising\" or \"qubo\", found \"" + type + "\"");
  const JsonReader answer = reader.object("answer");
  answer.expect_text("format", "qp");
  SampleSet samples;
  samples.vartype = type == "ising" ? Vartype::spin : Vartype::binary;
  const std::int64_t chip_size = answer.integer("num_variables", 0, INT32_MAX);
  std::int64_t next = 0;
  for (std::int32_t qubit :
       numbers_from_base64<std::int32_t>(answer.text("active_variables"), where + "active_variables")) {
    if (qubit < next || qubit >= chip_size)
      answer.fail("active_variables",
                  "qubit " + std::to_string(qubit) + " is out of order or not below " + std::to_string(chip_size));
    next = std::int64_t(qubit) + 1;
    samples.labels.emplace_back(std::int64_t(qubit));
  }
  samples.energies = numbers_from_base64<double>(answer.text("energies"), where + "energies");
  const double offset = answer.find("offset") ? answer.number("offset") : 0;
  for (double& energy : samples.energies) {
    if (!std::isfinite(energy)) answer.fail("energies", "an energy is not a finite number");
    energy += offset;
  }
  samples.occurrences = read_counts(answer, where, samples.row_count());
  samples.values = unpack_rows(answer, from_base64(answer.text("solutions"), where + "solutions"), samples.row_count(),
                               samples.variable_count(), samples.vartype == Vartype::binary ? 0 : -1);
  if (answer.find("timing")) samples.info["timing"] = answer.at("timing");
  return samples;
}

namespace {

const SapiSolver& solver_in(const FormatOptions& options) {
  if (!options.solver) throw InputError("sapi: the solver's graph is needed; give --solver or --graph");
  return *options.solver;
}

}  // namespace

extern const Format kSapi = {
    .name = "sapi",
    .extension = ".sapi.json",
    .about = "D-Wave SAPI v3 problem body, on qubits",
    .labels = false,
    .write = [](const Problem& problem,
                const FormatOptions& options) { return to_sapi(problem, solver_in(options), options.sapi); },
    .read = [](const std::string& text, const FormatOptions& options,
               const std::string& source) { return problem_from_sapi(text, solver_in(options), source); },
    .read_answer = [](const std::string& text, const Problem& problem,
                      const std::string& source) { return with_offset(samples_from_sapi(text, source), problem); }};

}  // namespace gonogo::learning
