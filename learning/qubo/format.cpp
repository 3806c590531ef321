#include "learning/qubo/format.h"

#include <algorithm>
#include <array>

#include "base/error.h"
#include "learning/qubo/bqm_file.h"
#include "learning/qubo/bqpjson.h"
#include "learning/qubo/coo.h"
#include "learning/qubo/dimod.h"
#include "learning/qubo/entries.h"
#include "learning/qubo/foreign_file.h"
#include "learning/qubo/optimisation_text.h"
#include "learning/qubo/qbsolv.h"

namespace gonogo::learning {
namespace {

using F = ProblemFormat;

constexpr std::array<FormatFacts, 10> kFormats = {{
    {.format = F::dimod_json,
     .name = "dimod_json",
     .extension = ".json",
     .about = "dimod to_serializable, bqm_schema 3.0.0"},
    {.format = F::dimod_bqm,
     .name = "dimod_bqm",
     .extension = ".bqm",
     .about = "dimod to_file, version 2; Leap uploads"},
    {.format = F::dimod_bqm_v1, .name = "dimod_bqm_v1", .extension = ".bqm", .about = "dimod to_file, version 1"},
    {.format = F::bqpjson, .name = "bqpjson", .extension = ".bqpjson", .about = "LANL bqpjson 1.0.0", .labels = false},
    {.format = F::coo,
     .name = "coo",
     .extension = ".coo",
     .about = "dimod coordinate text",
     .labels = false,
     .offset = false,
     .every_variable = false},
    {.format = F::qbsolv,
     .name = "qbsolv",
     .extension = ".qubo",
     .about = "qbsolv .qubo, as bqp2qubo writes it",
     .spin = false,
     .labels = false},
    {.format = F::mqlib,
     .name = "mqlib",
     .extension = ".mqlib",
     .about = "MQLib: maximise, symmetric matrix",
     .spin = false,
     .labels = false,
     .offset = false,
     .zeros = false},
    {.format = F::biq_mac,
     .name = "biq_mac",
     .extension = ".bq",
     .about = "Biq Mac: minimise, symmetric matrix",
     .spin = false,
     .labels = false,
     .offset = false,
     .zeros = false},
    {.format = F::rudy,
     .name = "rudy",
     .extension = ".mc",
     .about = "rudy, G-set: maximum cut, no linear biases",
     .binary = false,
     .labels = false,
     .offset = false,
     .zeros = false},
    {.format = F::sapi,
     .name = "sapi",
     .extension = ".sapi.json",
     .about = "D-Wave SAPI v3 problem body, on qubits",
     .labels = false},
}};

bool has_text_labels(const Problem& problem) {
  return std::any_of(problem.labels.begin(), problem.labels.end(),
                     [](const Label& label) { return !std::holds_alternative<std::int64_t>(label); });
}

bool numbered_from_one(F format) { return format == F::mqlib || format == F::biq_mac || format == F::rudy; }

/// Drops what the format would lose silently when read back: zero couplings and the sign of zeros.
void normalise(Problem& problem, const FormatFacts& format, std::vector<std::string>& notes) {
  if (format.labels) return;
  problem.offset += 0.0;
  for (double& bias : problem.linear) bias += 0.0;
  for (Coupling& c : problem.couplings) c.value += 0.0;
  if (format.zeros) return;
  const std::size_t dropped = std::erase_if(problem.couplings, [](const Coupling& c) { return c.value == 0; });
  if (dropped > 0) notes.push_back(std::to_string(dropped) + " couplings of value 0 are left out");
}

std::size_t isolated_count(const Problem& problem) {
  std::vector<bool> seen(problem.variable_count(), false);
  for (const Coupling& c : problem.couplings) seen[c.a] = seen[c.b] = true;
  std::size_t count = 0;
  for (std::size_t i = 0; i < seen.size(); ++i) count += !seen[i] && problem.linear[i] == 0;
  return count;
}

void note_losses(const Problem& problem, const FormatFacts& format, std::vector<std::string>& notes) {
  const std::string name = format.name;
  if (!format.offset && problem.offset != 0)
    notes.push_back(name + " has no place for the offset; the sidecar keeps it");
  if (!format.labels && has_text_labels(problem))
    notes.push_back(name + " numbers its variables; the sidecar keeps their labels");
  const std::size_t isolated = format.every_variable ? 0 : isolated_count(problem);
  if (isolated > 0)
    notes.push_back(name + " has no place for " + std::to_string(isolated) +
                    " variables without coefficients; the sidecar keeps them");
}

std::vector<std::int64_t> ids_for(const Problem& problem, const FormatFacts& format) {
  if (format.labels) return {};
  if (!numbered_from_one(format.format)) return file_ids(problem);
  std::vector<std::int64_t> ids(problem.variable_count());  // read back as the number less one
  for (std::size_t i = 0; i < ids.size(); ++i) ids[i] = std::int64_t(i);
  return ids;
}

std::string text_of(const Problem& problem, F format, const FormatOptions& options) {
  switch (format) {
    case F::dimod_json:
      return to_dimod_json(problem) + "\n";
    case F::dimod_bqm:
      return to_bqm_file(problem, 2);
    case F::dimod_bqm_v1:
      return to_bqm_file(problem, 1);
    case F::bqpjson:
      return to_bqpjson(problem);
    case F::coo:
      return to_coo(problem);
    case F::qbsolv:
      return to_qbsolv(problem);
    case F::mqlib:
      return to_optimisation_text(problem, OptimisationDialect::mqlib);
    case F::biq_mac:
      return to_optimisation_text(problem, OptimisationDialect::biq_mac);
    case F::rudy:
      return to_optimisation_text(problem, OptimisationDialect::rudy);
    default:
      return to_sapi(problem, *options.solver, options.sapi);
  }
}

void expect_solver(const FormatOptions& options) {
  if (!options.solver) throw InputError("sapi: the solver's graph is needed; give --solver or --graph");
}

}  // namespace

std::span<const FormatFacts> problem_formats() { return kFormats; }

const FormatFacts& facts(ProblemFormat format) { return kFormats[std::size_t(format)]; }

const FormatFacts& format_named(const std::string& name) {
  std::string names;
  for (const FormatFacts& format : kFormats) {
    if (format.name == name) return format;
    names += (names.empty() ? "" : ", ") + std::string(format.name);
  }
  throw InputError("format \"" + name + "\" does not exist; use one of " + names);
}

std::optional<ProblemFormat> format_of_file(const std::string& file_name) {
  const auto ends = [&](const std::string& extension) { return file_name.ends_with(extension); };
  if (ends(facts(F::sapi).extension)) return F::sapi;
  for (const FormatFacts& format : kFormats)
    if (ends(format.extension)) return format.format;
  return std::nullopt;
}

WrittenProblem write_problem(const Problem& problem, ProblemFormat format, const FormatOptions& options) {
  const FormatFacts& fact = facts(format);
  if (format == F::sapi) expect_solver(options);
  WrittenProblem result;
  result.problem = problem;
  const bool holds = problem.vartype == Vartype::binary ? fact.binary : fact.spin;
  if (!holds) {
    const Vartype other = problem.vartype == Vartype::binary ? Vartype::spin : Vartype::binary;
    result.problem = to_vartype(problem, other);
    result.notes.push_back("converted to " + vartype_name(other) + ", the only kind " + fact.name + " holds");
  }
  normalise(result.problem, fact, result.notes);
  note_losses(result.problem, fact, result.notes);
  result.ids = ids_for(result.problem, fact);
  result.text = text_of(result.problem, format, options);
  return result;
}

Problem read_problem(const std::string& text, ProblemFormat format, const FormatOptions& options,
                     const std::string& source) {
  refuse_foreign_file(text, source);
  switch (format) {
    case F::dimod_json:
      return problem_from_dimod_json(text, source);
    case F::dimod_bqm:
    case F::dimod_bqm_v1:
      return problem_from_bqm_file(text, source);
    case F::bqpjson:
      return problem_from_bqpjson(text, source);
    case F::coo:
      return problem_from_coo(text, options.vartype, source);
    case F::qbsolv:
      return problem_from_qbsolv(text, source);
    case F::mqlib:
      return problem_from_optimisation_text(text, OptimisationDialect::mqlib, source);
    case F::biq_mac:
      return problem_from_optimisation_text(text, OptimisationDialect::biq_mac, source);
    case F::rudy:
      return problem_from_optimisation_text(text, OptimisationDialect::rudy, source);
    default:
      expect_solver(options);
      return problem_from_sapi(text, *options.solver, source);
  }
}

}  // namespace gonogo::learning
