// Files of annealing problems with their sidecars.
//
// The problem has any format of learning/formats/format.h, for any tool. <problem>.sidecar.json says what its numbers
// mean. For a problem made from a model it also holds the model's hash, the clamped variables and the layout of the
// units.
#pragma once
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "learning/encoding/layout.h"
#include "learning/formats/format.h"
#include "learning/qubo/problem.h"

namespace gonogo::outcome {

struct Sidecar : learning::ProblemSidecar {
  std::string model_hash;                  // empty: the problem was not exported from a model
  std::map<std::string, double> clamped;   // variable -> value [unit of the variable]
  std::optional<learning::Problem> words;  // the machine over code words, of a problem with free units
  double code_penalty = 0;                 // energy added to words that are no code words (with_code_penalty())
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

/// Writes a problem and its sidecar, which brings model, embedding, gauge and scale; the rest of it is set anew.
Exported write_problem_file(const learning::Problem& problem, Sidecar sidecar, const std::filesystem::path& path,
                            const FileChoice& choice);

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

}  // namespace gonogo::outcome
