// A model's machine as an annealing problem, and answers to it read back.
//
// An export is two files: the problem, in any format of learning/qubo/format.h, for any tool, and
// <problem>.sidecar.json, which says what the numbers mean (learning/qubo/sidecar.h) and, for a problem made from a
// model, the model's hash, the clamped variables and the layout of its units.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "base/json/json.h"
#include "learning/encoding/layout.h"
#include "learning/model/model.h"
#include "learning/qubo/format.h"
#include "learning/qubo/sidecar.h"
#include "learning/sampler/sampler.h"

namespace gonogo::learn {

struct Sidecar : learning::ProblemSidecar {
  std::string model_hash;                 // empty: the problem was not exported from a model
  std::map<std::string, double> clamped;  // variable -> value [unit of the variable]
  double code_penalty = 0;                // energy of words that are no code words (learning/encoding/code_penalty.h)
  learning::VisibleLayout layout;
  bool of_model() const { return !model_hash.empty(); }
};

/// How a file is read or written: a format's name ("" goes by the file's extension), the solver of SAPI bodies, the
/// vartype of coordinate text without a header.
struct FileChoice {
  std::string format;
  std::filesystem::path solver;
  std::string vartype;
};

struct Exported {
  Sidecar sidecar;
  std::vector<std::string> notes;  // what was converted, and what the problem file cannot hold
};

/// Writes problem and sidecar. `clamped` variables are taken out of the problem by their smooth code, the others get
/// `code_penalty`. Throws InputError for variables that are not in the model or not finite and for a penalty below 0.
Exported export_problem(const std::filesystem::path& model, const std::filesystem::path& problem,
                        const std::map<std::string, double>& clamped, learning::Vartype vartype,
                        const FileChoice& choice = {}, double code_penalty = 0);

struct LoadedProblem {
  learning::Problem problem;
  std::optional<Sidecar> sidecar;  // the one beside the file, if there is one
};

/// Reads a problem of any format; with a sidecar beside it, labels, order and offset are restored and the hash checked.
LoadedProblem load_problem(const std::filesystem::path& path, const FileChoice& choice = {});

/// Writes a problem and its sidecar in another format; what the old sidecar said about model and embedding is kept.
Exported convert_problem(const LoadedProblem& loaded, const std::filesystem::path& path, const FileChoice& choice);

/// Reads and checks; throws InputError for a sidecar that does not belong to `problem`.
Sidecar read_sidecar(const std::filesystem::path& path);

/// Samples a problem file and writes the answer in dimod's form, with the problem's hash in its info.
Json sample_problem(const std::filesystem::path& problem, const std::filesystem::path& answer,
                    const learning::Sampler& sampler, const learning::SampleRequest& request,
                    const FileChoice& choice = {});

struct ImportRequest {
  std::filesystem::path problem, answer;
  FileChoice problem_file;
  std::string answer_format = "dimod_json";
  std::filesystem::path model;  // not empty: the problem must be of this model (hash of its file)
  std::filesystem::path rows;   // not empty: one line of CSV for each valid row
  learning::DecodeRule rule = learning::DecodeRule::discard;
  std::string chains = "weighted_random";  // policy for broken chains of an embedded problem
  std::uint64_t seed = 1;                  // of that policy
};

/// Reads an answer back: verifies labels, hash and energies; for an embedded problem undoes gauge and embedding. For a
/// problem made from a model also decodes every row: counts of valid rows, outcome frequencies with standard errors,
/// mean and spread of the variables over valid rows.
Json import_answer(const ImportRequest& request);

}  // namespace gonogo::learn
