// What D-Wave's solver interface (SAPI, resource representation version 3) takes and gives for problems on qubits: the
// "qp" encoding. Facts: docs.dwavequantum.com "SAPI REST", dwave-cloud-client 0.14 coders.py.
//
//   problem  lin: f64 per qubit of the solver, NaN where the qubit is inactive; quad: f64 per coupler of the solver
//            with both ends active, in the solver's order. Active: has a bias or is an end of a given coupling.
//   answer   active_variables i32, energies f64 (ascending), num_occurrences i32 (histogram answers only), solutions:
//            ceil(active / 8) bytes per row, the first variable in the highest bit; all of it base64, little-endian.
#pragma once
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "base/json/json.h"
#include "learning/qubo/problem.h"
#include "learning/qubo/sample_set.h"

namespace gonogo::learning {

/// The working part of a solver's graph, in the order in which the solver lists it.
struct SapiSolver {
  std::string name, graph_id;
  std::int64_t chip_size = 0;  // num_qubits of the solver, dead ones included
  std::vector<std::int64_t> qubits;
  std::vector<std::pair<std::int64_t, std::int64_t>> couplers;
};

/// From a solver definition as SAPI serves it: id or identity.name, identity.version.graph_id, properties.num_qubits,
/// properties.qubits, properties.couplers. Throws InputError for couplers between unlisted qubits and repeats.
SapiSolver solver_from_json(const Json& json, const std::string& source);

struct SapiSettings {
  Json params = Json::object();  // num_reads, annealing_time [us], auto_scale, answer_mode, ...
  std::string label;             // of the problem; empty for none
};

/// Body of POST problems/: a list of one problem, one line with its end. Labels of the problem must be qubits of the
/// solver and its couplings couplers of the solver; throws InputError otherwise. Zero couplings make their ends active.
std::string to_sapi(const Problem& problem, const SapiSolver& solver, const SapiSettings& settings);

/// The inverse: variables are the active qubits. Throws InputError for another solver name or graph, lengths that do
/// not fit the solver, values that are not finite where a qubit is active, and unknown formats.
Problem problem_from_sapi(const std::string& text, const SapiSolver& solver, const std::string& source);

/// Answer of a solved problem: {"type", "answer": {...}, ...} as GET problems/<id> serves it. The rows must be ordered
/// by energy where `histogram` is set. Columns are the problem's variables by ascending qubit.
std::string to_sapi_answer(const SampleSet& samples, std::int64_t chip_size, bool histogram, const Json& timing);

/// Raw and histogram answers. The offset of the answer, if any, is added to the energies. Throws InputError for lengths
/// that do not fit each other, repeated or unordered qubits, counts below 1, and statuses other than COMPLETED.
SampleSet samples_from_sapi(const std::string& text, const std::string& source);

}  // namespace gonogo::learning
