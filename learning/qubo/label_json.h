// Labels and vartypes as dimod writes them into JSON.
#pragma once
#include <string>
#include <vector>

#include "learning/qubo/json_reader.h"
#include "learning/qubo/problem.h"

namespace gonogo::learning {

Json labels_json(const std::vector<Label>& labels);

/// Texts and whole numbers; throws InputError for others (dimod also knows fractions and tuples) and for another count.
std::vector<Label> labels_from_json(const JsonReader& reader, const std::string& key, std::size_t count);

/// "BINARY" or "SPIN".
Vartype vartype_from_json(const JsonReader& reader, const std::string& key);

}  // namespace gonogo::learning
