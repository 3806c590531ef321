// A model's machine as an annealing problem, and answers to it read back.
//
// An export is two files: <problem>.json in dimod's form, for any tool, and <problem>.sidecar.json, which says what the
// numbers mean: vartype, offset, scale and beta (P(x) proportional to exp(-beta E(x) / scale)), labels, clamped
// variables, layout, and the hash that ties answers to this very problem.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>

#include "base/json/json.h"
#include "learning/encoding/layout.h"
#include "learning/model/model.h"
#include "learning/qubo/problem.h"

namespace gonogo::pipeline {

struct Sidecar {
  std::string problem_hash, model_hash;
  learning::Vartype vartype = learning::Vartype::binary;
  double offset = 0, scale = 1, beta = 1;
  std::vector<std::string> labels;
  std::map<std::string, double> clamped;  // variable -> value [unit of the variable]
  learning::VisibleLayout layout;
};

std::filesystem::path sidecar_path(const std::filesystem::path& problem);

/// Writes problem and sidecar. `clamped` variables are taken out of the problem by their smooth code. Throws InputError
/// for variables that are not in the model or not finite.
Sidecar export_problem(const std::filesystem::path& model, const std::filesystem::path& problem,
                       const std::map<std::string, double>& clamped, learning::Vartype vartype);

/// Strict; refuses a sidecar that does not belong to `problem` (other hash, labels, vartype or offset).
Sidecar read_sidecar(const std::filesystem::path& path, const learning::Problem& problem);

/// Samples a problem file and writes the answer in dimod's form, with the problem's hash in its info.
Json sample_problem(const std::filesystem::path& problem, const std::filesystem::path& answer,
                    const std::string& sampler, std::size_t reads, std::size_t sweeps, std::uint64_t seed);

/// Reads an answer back: verifies labels, hash and energies, decodes every row. Returns counts of valid rows, outcome
/// frequencies with standard errors, and mean and spread of the variables over valid rows. With `model` the problem
/// must be of that model (hash of its file). With `rows` not empty, writes one line of CSV for each valid row.
Json import_answer(const std::filesystem::path& problem, const std::filesystem::path& answer,
                   const std::filesystem::path& model, const std::filesystem::path& rows,
                   learning::DecodeRule rule = learning::DecodeRule::discard);

}  // namespace gonogo::pipeline
