// Lists of coefficients (i, j, value), with i = j for linear terms, as in text formats; and problems from them.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "learning/qubo/problem.h"

namespace gonogo::learning {

inline constexpr std::int64_t kMaxId = INT32_MAX;
inline constexpr std::int64_t kMaxVariables = 10'000'000;  // in formats that declare a count without a list

struct Entry {
  std::int64_t i = 0, j = 0;
  double value = 0;
};

enum class Repeats { add, refuse };

/// Variables are all ids in `ids` and `entries`, ascending, with the id as label. A pair may be in either order. Throws
/// InputError for repeated entries, unless they are allowed.
Problem problem_from_entries(Vartype vartype, std::vector<std::int64_t> ids, const std::vector<Entry>& entries,
                             Repeats repeats, const std::string& source);

/// Id of each variable in formats without labels: the label, when all labels are different integers from 0 to
/// kMaxId; otherwise the position.
std::vector<std::int64_t> file_ids(const Problem& problem);

/// Couplings as (smaller id, larger id, value), sorted.
std::vector<Entry> coupling_entries(const Problem& problem, const std::vector<std::int64_t>& ids);

/// Positions of the variables by ascending id.
std::vector<std::size_t> by_id(const std::vector<std::int64_t>& ids);

}  // namespace gonogo::learning
