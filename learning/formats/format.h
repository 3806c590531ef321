// File formats of problems and answers, by name, and the sidecar that keeps what a format cannot hold.
#pragma once
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/json/config.h"
#include "learning/formats/sapi.h"
#include "learning/qubo/problem.h"
#include "learning/qubo/sample_set.h"

namespace gonogo::learning {

struct FormatOptions {
  const SapiSolver* solver = nullptr;  // sapi
  SapiSettings sapi;
  std::optional<Vartype> vartype;  // of a coo file without a header
};

/// A format of problems, of answers, or of both: a file of this folder, and its name in format.cpp.
struct Format {
  const char* name;
  const char* extension = "";       // the usual one of problems
  const char* about = "";           // its program and version, or what it holds
  bool binary = true, spin = true;  // vartypes it can hold
  bool labels = true;               // any labels; otherwise variables are numbers
  bool from_one = false;            // the numbers are 1, 2, ... in the problem's order; otherwise file_ids()
  bool offset = true;
  bool every_variable = true;  // keeps variables without coefficients
  bool zeros = true;           // keeps couplings of value 0
  /// Bytes of a problem that the format can hold. Null, as `read`: a format of answers only.
  std::string (*write)(const Problem& problem, const FormatOptions& options) = nullptr;
  /// The inverse. Variables are numbers, from 0, where the format has no labels. Messages begin with `source`.
  Problem (*read)(const std::string& text, const FormatOptions& options, const std::string& source) = nullptr;
  /// An answer to `problem`. Null: a format of problems only.
  SampleSet (*read_answer)(const std::string& text, const Problem& problem, const std::string& source) = nullptr;
};

/// Formats of problems, and of answers.
const std::vector<const Format*>& problem_formats();
const std::vector<const Format*>& answer_formats();
std::vector<std::string> names_of(const std::vector<const Format*>& formats);
/// Throw InputError that lists the names.
const Format& format_named(const std::string& name);
const Format& answer_format_named(const std::string& name);
/// Format of a file name's extension; ".json" is dimod's. Null for unknown extensions.
const Format* format_of_file(const std::string& file_name);

struct WrittenProblem {
  std::string text;
  Problem problem;                 // the problem, with labels and offset that the file may not have
  std::vector<std::int64_t> ids;   // id of each variable in the file; empty if it has labels
  std::vector<std::string> notes;  // one sentence for each conversion or loss
};

/// Converts the vartype and drops couplings of value 0 if the format needs it. Throws InputError when the format cannot
/// hold the problem.
WrittenProblem write_problem(const Problem& problem, const Format& format, const FormatOptions& options = {});

/// The content of the file. Formats without labels give ids, formats without offset give 0; restore() adds what is
/// missing.
Problem read_problem(const std::string& text, const Format& format, const FormatOptions& options,
                     const std::string& source);

/// Reads an answer to `problem`. Labels (qbsolv) and energies (csv) that the file does not have come from the problem.
SampleSet read_answer(const std::string& text, const Format& format, const Problem& problem, const std::string& source);

/// Hash of vartype, labels, biases, couplings and offset, by which an answer names its problem.
std::string problem_hash(const Problem& problem);

/// The answer in the problem's vartype and order of variables. Throws InputError when it belongs to another problem: by
/// its labels, by "problem_hash" in its info, or by its energies. Energies may differ by 1e-6 of the problem's largest
/// energy difference, because some tools compute in single precision.
SampleSet check_answer(const Problem& problem, const SampleSet& answer, const std::string& source);

/// Answers as csv: a header of labels or ids, one row of values per line, then energy and num_occurrences. The reader
/// takes columns in any order and does without the last two.
std::string samples_csv(const SampleSet& samples);

/// Embedding of a problem on qubits. Chain k is variable k of `source`.
struct EmbeddingRecord {
  std::string graph;                                // "chimera:12", or the solver's name
  std::vector<std::vector<std::int64_t>> chains{};  // qubits
  double chain_strength = 0;
  Problem source{};
  std::vector<std::pair<std::uint32_t, std::uint32_t>> uncoupled{};  // pairs of `source` without a coupler
  bool operator==(const EmbeddingRecord&) const = default;
};

/// The sidecar of an exported problem: all that its format cannot hold but an import of the answer needs.
struct ProblemSidecar {
  std::string problem_hash;
  const Format* format = nullptr;
  Vartype vartype = Vartype::binary;
  double offset = 0;
  double scale = 1, beta = 1;        // P(x) proportional to exp(-beta E(x) / scale), E in the file
  std::vector<Label> labels;         // of the problem's variables
  std::vector<std::int64_t> ids;     // ids in the file; empty if the format has labels
  std::vector<std::int8_t> gauge{};  // -1: the variable's sign is flipped in the file; empty: none
  std::optional<EmbeddingRecord> embedding{};
};

ProblemSidecar sidecar_of(const WrittenProblem& written, const Format& format);

/// <problem>.sidecar.json, with the extension of the problem kept: p.json and p.qubo have one each.
std::filesystem::path sidecar_path(const std::filesystem::path& problem);

/// Members "format" to "embedding". Callers may append their own.
Json to_json(const ProblemSidecar& sidecar);

/// Reads these members. The caller reads others and calls finish(). Throws InputError with file and place.
ProblemSidecar sidecar_from_json(const Config& config);

/// The exported problem: `read` plus the sidecar's labels, order, offset, and variables without coefficients. Throws
/// InputError when hash, vartype or variables do not match the sidecar.
Problem restore(const Problem& read, const ProblemSidecar& sidecar, const std::string& source);

/// Throws InputError that names the kind of file and the remedy, for files of dimod that hold other models (CQM, DQM,
/// QM), LP files, pickles, ZIP archives and HDF5 files. Returns for everything else.
void refuse_foreign_file(std::string_view bytes, const std::string& source);

}  // namespace gonogo::learning
