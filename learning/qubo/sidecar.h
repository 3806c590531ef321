// The sidecar of an exported problem: all that its format cannot hold but an import of the answer needs. It has
// vartype, offset, scale and beta, labels and ids, gauge, the embedding with its source problem, and the problem's
// hash.
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/json/config.h"
#include "learning/qubo/format.h"
#include "learning/qubo/problem.h"

namespace gonogo::learning {

/// Embedding of a problem on qubits. Chain k is variable k of `source`.
struct EmbeddingRecord {
  std::string graph;                              // "chimera:12", or the solver's name
  std::vector<std::vector<std::int64_t>> chains;  // qubits
  double chain_strength = 0;
  Problem source;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> uncoupled;  // pairs of `source` without a coupler
  bool operator==(const EmbeddingRecord&) const = default;
};

struct ProblemSidecar {
  std::string problem_hash;
  ProblemFormat format = ProblemFormat::dimod_json;
  Vartype vartype = Vartype::binary;
  double offset = 0;
  double scale = 1, beta = 1;      // P(x) proportional to exp(-beta E(x) / scale), E in the file
  std::vector<Label> labels;       // of the problem's variables
  std::vector<std::int64_t> ids;   // ids in the file; empty if the format has labels
  std::vector<std::int8_t> gauge;  // -1: the variable's sign is flipped in the file; empty: none
  std::optional<EmbeddingRecord> embedding;
};

ProblemSidecar sidecar_of(const WrittenProblem& written, ProblemFormat format);

/// <problem>.sidecar.json, with the extension of the problem kept: p.json and p.qubo have one each.
std::filesystem::path sidecar_path(const std::filesystem::path& problem);

/// Members "format" to "embedding". Callers may append their own.
Json to_json(const ProblemSidecar& sidecar);

/// Reads these members. The caller reads others and calls finish(). Throws InputError with file and place.
ProblemSidecar sidecar_from_json(const Config& config);

/// The exported problem: `read` plus the sidecar's labels, order, offset, and variables without coefficients. Throws
/// InputError when hash, vartype or variables do not match the sidecar.
Problem restore(const Problem& read, const ProblemSidecar& sidecar, const std::string& source);

}  // namespace gonogo::learning
