// All file formats of problems and answers by name, with what each can hold.
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
  const char* extension;  // usual one
  const char* about;
  bool binary = true, spin = true;  // vartypes it can hold
  bool labels = true;               // texts as labels; otherwise variables are numbered
  bool offset = true;
  bool every_variable = true;  // also those without a coefficient
  bool zeros = true;           // couplings of value 0
};

std::span<const FormatFacts> problem_formats();
/// Throws InputError that lists the names.
const FormatFacts& format_named(const std::string& name);
const FormatFacts& facts(ProblemFormat format);
/// By the usual extension of a file's name, ".json" being dimod's; nothing for unknown ones.
std::optional<ProblemFormat> format_of_file(const std::string& file_name);

struct FormatOptions {
  const SapiSolver* solver = nullptr;  // sapi
  SapiSettings sapi;
  std::optional<Vartype> vartype;  // coo without a header
};

struct WrittenProblem {
  std::string text;
  Problem problem;                 // what the file stands for, with labels and offset that the file may lack
  std::vector<std::int64_t> ids;   // number of each variable in the file; empty where the format holds labels
  std::vector<std::string> notes;  // what was converted and what the file itself cannot hold, a sentence each
};

/// Converts the vartype where the format needs the other one, drops zero couplings where they cannot be held. Throws
/// InputError where the format cannot hold the problem at all.
WrittenProblem write_problem(const Problem& problem, ProblemFormat format, const FormatOptions& options = {});

/// What stands in the file: formats without labels give numbers, formats without offset 0. restore() puts the rest
/// back.
Problem read_problem(const std::string& text, ProblemFormat format, const FormatOptions& options,
                     const std::string& source);

enum class AnswerFormat { dimod_json, sapi, qbsolv, csv };
std::string answer_format_names();
AnswerFormat answer_format_named(const std::string& name);

/// Answers whose format has no labels (qbsolv) or no energies (csv: a header of labels, one row of values per line,
/// optional columns "energy" and "num_occurrences") get them from the problem; columns of numbers are its ids.
SampleSet read_answer(const std::string& text, AnswerFormat format, const Problem& problem, const std::string& source);

/// The csv form that read_answer() reads, with energies and counts.
std::string samples_csv(const SampleSet& samples);

}  // namespace gonogo::learning
