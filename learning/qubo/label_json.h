// Labels and vartypes in dimod's JSON.
#pragma once
#include <string>
#include <vector>

#include "learning/qubo/json_reader.h"
#include "learning/qubo/problem.h"

namespace gonogo::learning {

Json labels_json(const std::vector<Label>& labels);

/// Texts and integers. Throws InputError for dimod's other labels (fractions, tuples) and for another count.
std::vector<Label> labels_from_json(const JsonReader& reader, const std::string& key, std::size_t count);

/// "BINARY" or "SPIN".
Vartype vartype_from_json(const JsonReader& reader, const std::string& key);

}  // namespace gonogo::learning
