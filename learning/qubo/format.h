// All file formats of problems and answers, by name, with their capabilities.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "learning/qubo/problem.h"
#include "learning/qubo/sample_set.h"
#include "learning/qubo/sapi.h"

namespace gonogo::learning {

enum class ProblemFormat { dimod_json, dimod_bqm, dimod_bqm_v1, bqpjson, coo, qbsolv, mqlib, biq_mac, rudy, sapi };

struct FormatFacts {
  ProblemFormat format;
  const char* name;
  const char* extension;  // the usual one
  const char* about;
  bool binary = true, spin = true;  // vartypes it can hold
  bool labels = true;               // any labels; otherwise variables are numbers
  bool offset = true;
  bool every_variable = true;  // keeps variables without coefficients
  bool zeros = true;           // keeps couplings of value 0
};

std::span<const FormatFacts> problem_formats();
/// Throws InputError that lists the names.
const FormatFacts& format_named(const std::string& name);
const FormatFacts& facts(ProblemFormat format);
/// Format of a file name's extension; ".json" is dimod's. Empty for unknown extensions.
std::optional<ProblemFormat> format_of_file(const std::string& file_name);

struct FormatOptions {
  const SapiSolver* solver = nullptr;  // sapi
  SapiSettings sapi;
  std::optional<Vartype> vartype;  // of a coo file without a header
};

struct WrittenProblem {
  std::string text;
  Problem problem;                 // the problem, with labels and offset that the file may not have
  std::vector<std::int64_t> ids;   // id of each variable in the file; empty if it has labels
  std::vector<std::string> notes;  // one sentence for each conversion or loss
};

/// Converts the vartype and drops couplings of value 0 if the format needs it. Throws InputError when the format cannot
/// hold the problem.
WrittenProblem write_problem(const Problem& problem, ProblemFormat format, const FormatOptions& options = {});

/// The content of the file. Formats without labels give ids, formats without offset give 0; restore() of sidecar.h adds
/// what is missing.
Problem read_problem(const std::string& text, ProblemFormat format, const FormatOptions& options,
                     const std::string& source);

enum class AnswerFormat { dimod_json, sapi, qbsolv, csv };
std::string answer_format_names();
AnswerFormat answer_format_named(const std::string& name);

/// Reads an answer to `problem`. Labels (qbsolv) and energies (csv) that the file does not have come from the problem.
/// csv: a header of labels or ids, one row of values per line, optional columns "energy" and "num_occurrences".
SampleSet read_answer(const std::string& text, AnswerFormat format, const Problem& problem, const std::string& source);

/// The csv of read_answer(), with energies and counts.
std::string samples_csv(const SampleSet& samples);

}  // namespace gonogo::learning
