// What a problem file cannot say about itself, written beside every export, so that somebody else can import an answer
// later: vartype, offset, scale and beta, labels and the numbers that stand for them, gauge, embedding with the problem
// that was embedded, and the hash that ties answers to this very problem.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/json/config.h"
#include "learning/qubo/format.h"
#include "learning/qubo/problem.h"

namespace gonogo::learning {

/// How a problem of other variables was laid onto qubits; chain k stands for variable k of `source`.
struct EmbeddingRecord {
  std::string graph;                              // "chimera:12", or the solver's name
  std::vector<std::vector<std::int64_t>> chains;  // qubits
  double chain_strength = 0;
  Problem source;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> uncoupled;  // pairs of `source` that had to be masked
  bool operator==(const EmbeddingRecord&) const = default;
};

struct ProblemSidecar {
  std::string problem_hash;
  ProblemFormat format = ProblemFormat::dimod_json;
  Vartype vartype = Vartype::binary;
  double offset = 0;
  double scale = 1, beta = 1;      // P(x) proportional to exp(-beta E(x) / scale), E of the problem in the file
  std::vector<Label> labels;       // of the problem's variables
  std::vector<std::int64_t> ids;   // their numbers in the file, where the format has no labels; otherwise empty
  std::vector<std::int8_t> gauge;  // -1 where the variable's sign was turned in the file; empty for none
  std::optional<EmbeddingRecord> embedding;
};

ProblemSidecar sidecar_of(const WrittenProblem& written, ProblemFormat format);

/// <problem>.sidecar.json: the whole name is kept, so that p.json and p.qubo have one each.
std::filesystem::path sidecar_path(const std::filesystem::path& problem);

/// Members "format" to "embedding"; a caller may append its own.
Json to_json(const ProblemSidecar& sidecar);

/// Reads the members above; leaves others to the caller, who calls finish(). Throws InputError naming file and place.
ProblemSidecar sidecar_from_json(const Config& config);

/// The problem as exported: `read` with the sidecar's labels, order, offset and variables without coefficients. Throws
/// InputError when its hash, vartype or variables are not the sidecar's.
Problem restore(const Problem& read, const ProblemSidecar& sidecar, const std::string& source);

}  // namespace gonogo::learning
