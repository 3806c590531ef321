// The "qp" encoding of problems and answers on qubits in D-Wave's solver interface (SAPI, resource representation
// version 3). Sources: docs.dwavequantum.com "SAPI REST", dwave-cloud-client 0.14 coders.py.
//
//   problem  lin: f64 per qubit of the solver, NaN for inactive ones. quad: f64 per coupler with two active ends, in
//   the
//            solver's order. A qubit is active if it has a bias or a coupling.
//   answer   active_variables: i32. energies: f64, ascending. num_occurrences: i32, only in histogram answers.
//   solutions:
//            ceil(active / 8) bytes per row, the first variable in the highest bit.
// All arrays are base64 of little-endian bytes.
#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "base/json/json.h"
#include "learning/qubo/problem.h"
#include "learning/qubo/sample_set.h"

namespace gonogo::learning {

/// The working graph of a solver, in the solver's order.
struct SapiSolver {
  std::string name{}, graph_id{};
  std::int64_t chip_size = 0;  // num_qubits, dead ones included
  std::vector<std::int64_t> qubits{};
  std::vector<std::pair<std::int64_t, std::int64_t>> couplers{};
};

/// From SAPI's definition of a solver: id or identity.name, identity.version.graph_id, properties.num_qubits,
/// properties.qubits, properties.couplers. Throws InputError for couplers between unlisted qubits and repeats.
SapiSolver solver_from_json(const Json& json, const std::string& source);

struct SapiSettings {
  Json params = Json::object();  // num_reads, annealing_time [us], auto_scale, answer_mode, ...
  std::string label;             // of the problem; empty for none
};

/// Body of POST problems/: a list of one problem, and a newline. Throws InputError unless labels are qubits of the
/// solver and couplings are couplers of it. Couplings of 0 make their ends active.
std::string to_sapi(const Problem& problem, const SapiSolver& solver, const SapiSettings& settings);

/// The inverse. Variables are the active qubits. Throws InputError for another solver or graph, lengths that do not
/// match the solver, values of active qubits that are not finite, and unknown formats.
Problem problem_from_sapi(const std::string& text, const SapiSolver& solver, const std::string& source);

/// Answer of a solved problem, {"type", "answer": {...}, ...}, as from GET problems/<id>. Columns are ordered by qubit.
/// With `histogram` the rows must be sorted by energy.
std::string to_sapi_answer(const SampleSet& samples, std::int64_t chip_size, bool histogram, const Json& timing);

/// Reads raw and histogram answers. Adds the answer's offset, if any, to the energies. Throws InputError for
/// inconsistent lengths, repeated or unsorted qubits, counts below 1, and statuses other than COMPLETED.
SampleSet samples_from_sapi(const std::string& text, const std::string& source);

}  // namespace gonogo::learning
