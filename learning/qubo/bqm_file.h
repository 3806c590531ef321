// dimod's binary file of a problem (BinaryQuadraticModel.to_file / from_file), which Leap's hybrid solvers accept.
// Layout: docs of dimod, "Format Specification" 1.0 and 2.0 of BinaryQuadraticModel.to_file.
//
//   "DIMODBQM", u8 major, u8 minor, u32 header length, header (JSON, newline, spaces up to a multiple of 64 bytes)
//   offset; for each variable: start of its neighbourhood, linear bias; for each variable: (neighbour, bias) ascending
//   2.0 only, when labels are not 0, 1, 2, ...: "VARS", u32 length, JSON list, spaces up to a multiple of 64 bytes
#pragma once
#include <string>
#include <string_view>

#include "learning/qubo/problem.h"

namespace gonogo::learning {

/// version: 1 (labels inside the header) or 2. The bytes are those of dimod 0.12 with float64 biases and int32 indices.
std::string to_bqm_file(const Problem& problem, int version = 2);

/// Reads 1.0 and 2.0 with float32 or float64 biases and indices of 4 or 8 bytes. Checks sizes before it allocates.
/// Rejects sizes that do not match the file, neighbourhoods that are unsorted or not symmetric, biases that are not
/// finite, and trailing bytes. Messages begin with `source`.
Problem problem_from_bqm_file(std::string_view bytes, const std::string& source);

}  // namespace gonogo::learning
