#include "learning/qubo/entries.h"

#include <algorithm>
#include <numeric>

#include "base/error.h"

namespace gonogo::learning {

Problem problem_from_entries(Vartype vartype, std::vector<std::int64_t> ids, const std::vector<Entry>& entries,
                             Repeats repeats, const std::string& source) {
  for (const Entry& e : entries) ids.insert(ids.end(), {e.i, e.j});
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  const auto place = [&](std::int64_t id) {
    return std::uint32_t(std::lower_bound(ids.begin(), ids.end(), id) - ids.begin());
  };
  Problem problem;
  problem.vartype = vartype;
  problem.labels.assign(ids.begin(), ids.end());
  problem.linear.assign(ids.size(), 0);
  std::vector<bool> has_linear(ids.size(), false);
  for (const Entry& e : entries) {
    const std::uint32_t a = place(std::min(e.i, e.j)), b = place(std::max(e.i, e.j));
    if (a != b) {
      problem.couplings.push_back({a, b, e.value});
      continue;
    }
    if (has_linear[a] && repeats == Repeats::refuse)
      throw InputError(source + ": the linear term of " + std::to_string(e.i) + " is given twice");
    has_linear[a] = true;
    problem.linear[a] += e.value;
  }
  auto& list = problem.couplings;
  std::stable_sort(list.begin(), list.end(),
                   [](const Coupling& x, const Coupling& y) { return std::pair(x.a, x.b) < std::pair(y.a, y.b); });
  std::size_t kept = 0;
  for (std::size_t k = 0; k < list.size(); ++k) {
    if (kept > 0 && list[kept - 1].a == list[k].a && list[kept - 1].b == list[k].b) {
      if (repeats == Repeats::refuse)
        throw InputError(source + ": the pair " + std::to_string(ids[list[k].a]) + ", " +
                         std::to_string(ids[list[k].b]) + " is given twice");
      list[kept - 1].value += list[k].value;
    } else {
      list[kept++] = list[k];
    }
  }
  list.resize(kept);
  check_problem(problem, source);
  return problem;
}

std::vector<std::int64_t> file_ids(const Problem& problem) {
  std::vector<std::int64_t> ids;
  for (const Label& label : problem.labels) {
    const auto* number = std::get_if<std::int64_t>(&label);
    if (!number || *number < 0 || *number > kMaxId) break;
    ids.push_back(*number);
  }
  if (ids.size() == problem.labels.size()) return ids;
  ids.resize(problem.labels.size());
  std::iota(ids.begin(), ids.end(), 0);
  return ids;
}

std::vector<Entry> coupling_entries(const Problem& problem, const std::vector<std::int64_t>& ids) {
  std::vector<Entry> entries;
  for (const Coupling& c : problem.couplings)
    entries.push_back({std::min(ids[c.a], ids[c.b]), std::max(ids[c.a], ids[c.b]), c.value});
  std::sort(entries.begin(), entries.end(),
            [](const Entry& x, const Entry& y) { return std::pair(x.i, x.j) < std::pair(y.i, y.j); });
  return entries;
}

std::vector<std::size_t> by_id(const std::vector<std::int64_t>& ids) {
  std::vector<std::size_t> order(ids.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::sort(order.begin(), order.end(), [&](std::size_t x, std::size_t y) { return ids[x] < ids[y]; });
  return order;
}

}  // namespace gonogo::learning
