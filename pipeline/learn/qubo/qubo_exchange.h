// Exports a model's machine as an annealing problem, and imports the answers.
//
// An export is two files. The problem has any format of learning/qubo/format.h, for any tool. <problem>.sidecar.json
// says what its numbers mean (learning/qubo/sidecar.h). For a problem made from a model it also holds the model's hash,
// the clamped variables and the layout of the units.
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
  double code_penalty = 0;                // energy added to words that are no code words (code_penalty.h)
  std::map<std::string, double>
      machine_answer;                          // P(outcome | clamped) of the machine's joint; empty: not known exactly
  std::map<std::string, double> model_answer;  // the same by the model, unknown inputs as in gonogo infer
  learning::VisibleLayout layout;
  bool of_model() const { return !model_hash.empty(); }
};

/// How a problem file is read or written.
struct FileChoice {
  std::string format;               // name of a format; empty: by the file's extension
  std::filesystem::path solver;     // SAPI solver definition, for SAPI bodies
  std::string vartype;              // of coordinate text without a header
  std::string option = "--format";  // of the command line, that gives `format`; messages name it
};

struct Exported {
  Sidecar sidecar;
  std::vector<std::string> notes;  // one sentence each: what was converted, and what the format cannot hold
};

/// Writes problem and sidecar. `clamped` variables are fixed to their smooth code and leave the problem; the others get
/// `code_penalty`, without a value as prepared_machine.h says; a note says which and why. Throws InputError for
/// variables that are not in the model or not finite, and for a negative penalty.
Exported export_problem(const std::filesystem::path& model, const std::filesystem::path& problem,
                        const std::map<std::string, double>& clamped, learning::Vartype vartype,
                        const FileChoice& choice = {}, std::optional<double> code_penalty = std::nullopt);

struct LoadedProblem {
  learning::Problem problem;
  std::optional<Sidecar> sidecar;  // the one beside the file; none: there is no sidecar
};

/// Reads a problem of any format. A sidecar beside it restores labels, order and offset. Throws InputError for a file
/// that cannot be read, and for a sidecar whose hash does not match.
LoadedProblem load_problem(const std::filesystem::path& path, const FileChoice& choice = {});

/// Writes a problem and its sidecar in another format. The new sidecar keeps model and embedding of the old one.
Exported convert_problem(const LoadedProblem& loaded, const std::filesystem::path& path, const FileChoice& choice);

/// Reads and checks a sidecar. Throws InputError for one that cannot be used.
Sidecar read_sidecar(const std::filesystem::path& path);

/// Samples a problem file and writes the answer in dimod's JSON form, with the problem's hash in its info.
Json sample_problem(const std::filesystem::path& problem, const std::filesystem::path& answer,
                    const learning::Sampler& sampler, const learning::SampleRequest& request,
                    const FileChoice& choice = {});

/// Writes rows drawn by a sampler as sample_problem() does. Returns what it returns.
Json write_answer(const learning::Problem& problem, learning::SampleSet answer, const std::string& sampler,
                  const learning::SampleRequest& request, const std::filesystem::path& answer_file);

/// How rows with words that are no code words are read (decode_answer.h).
enum class Decoding {
  weigh,    // the hidden units of every row weigh all code words
  discard,  // such rows are left out
  repair    // those that the rule of the code can read are kept
};
std::string decoding_name(Decoding decoding);

/// Answers below are refused.
struct ImportLimits {
  double reads = 100;   // weigh: independent reads that they are worth; otherwise reads that can be decoded
  double share = 0.05;  // of the reads
};

struct ImportRequest {
  std::filesystem::path problem, answer;
  FileChoice problem_file;
  std::string answer_format = "dimod_json";
  std::filesystem::path model;          // if given: the problem must come from this model file (by hash)
  std::filesystem::path rows;           // if given: CSV file for the valid rows
  bool inside = false;                  // its values are uniform inside their bins, by `seed`; otherwise the middles
  Decoding decoding = Decoding::weigh;  // falls back to discard if the machine has no sum over code words
  ImportLimits limits;
  std::string chains = "weighted_random";  // policy for broken chains of an embedded problem
  std::uint64_t seed = 1;                  // of that policy
};

/// Imports an answer: verifies labels, hash and energies, and undoes gauge and embedding of an embedded problem. For a
/// problem made from a model it also decodes the rows and adds summary_json(). Throws InputError for an answer that
/// does not belong to the problem, has no rows, or is below the limits.
Json import_answer(const ImportRequest& request);

}  // namespace gonogo::learn
