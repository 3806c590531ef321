#include "pipeline/learn/evaluation/curve_subset.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/random.h"

namespace gonogo::learn {
namespace {

constexpr std::uint64_t kGrowStream = 0x67726f77;  // stream of random numbers

}  // namespace

std::vector<std::uint64_t> grown_groups(const learning::TrainingTable& table, const std::vector<std::uint64_t>& taken,
                                        std::size_t count, const ModelAnswers& model, std::uint64_t seed) {
  std::map<std::uint64_t, std::size_t> first_row, size;
  for (std::size_t n = 0; n < table.row_count(); ++n) {
    first_row.try_emplace(table.group[n], n);
    ++size[table.group[n]];
  }
  std::vector<std::uint64_t> groups = taken, rest;
  std::size_t rows = 0;
  for (const std::uint64_t group : taken) {
    first_row.erase(group);
    rows += size.at(group);
  }
  std::vector<double> points;
  for (const auto& [group, row] : first_row) {
    rest.push_back(group);
    points.insert(points.end(), table.row(row).begin(), table.row(row).end());
  }
  if (rest.empty()) return groups;
  const std::vector<double> density =
      choice_densities(model, points, table.variable_count, BatchRequest{}.space_filling);
  // Without replacement: those with the least exponential times of rates `density` (Efraimidis & Spirakis, Inf.
  // Process. Lett. 97:181, 2006).
  std::vector<std::pair<double, std::uint64_t>> time;
  for (std::size_t i = 0; i < rest.size(); ++i)
    time.emplace_back(-std::log1p(-random_unit(seed, kGrowStream, rest[i])) / density[i], rest[i]);
  std::sort(time.begin(), time.end());
  for (const auto& [t, group] : time) {
    if (rows >= count) break;
    groups.push_back(group);
    rows += size.at(group);
  }
  std::sort(groups.begin(), groups.end());
  return groups;
}

}  // namespace gonogo::learn
