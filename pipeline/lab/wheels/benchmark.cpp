#include "pipeline/lab/wheels/benchmark.h"

#include <algorithm>

#include "base/error.h"
#include "base/nearest.h"

namespace gonogo::lab {

bool Benchmark::leads(Quantity q) const { return std::find(led.begin(), led.end(), q) != led.end(); }

std::vector<Quantity> Benchmark::measured() const {
  std::map<Quantity, bool> seen;
  for (const BenchmarkPoint& p : point)
    for (const auto& [quantity, value] : p.measured) seen[quantity] = true;
  std::vector<Quantity> all;
  for (const auto& [quantity, yes] : seen) all.push_back(quantity);
  return all;
}

double Benchmark::scatter_at(const BenchmarkPoint& p, Quantity q) const {
  const auto stated = scatter.find(q);
  const Measured& m = p.measured.at(q);
  const double of_repeats = std::max(m.high - m.mean, m.mean - m.low);
  return std::max(of_repeats, stated == scatter.end() ? 0 : stated->second);
}

bool is_whole(const Benchmark& b) { return !b.vehicle.empty() && Config::read(b.vehicle).text("kind") != "quarter"; }

void choose_state(Benchmark& b, const std::string& state) {
  if (state.empty()) return;
  std::vector<std::string> names;
  for (const terrain::SoilState& s : terrain::read_soil(b.soil_path).states) {
    names.push_back(s.name);
    if (s.name != state) continue;
    b.soil = s;
    return;
  }
  throw InputError(b.soil_path.string() + ": no state \"" + state + "\"; it has: " + join_words(names));
}

}  // namespace gonogo::lab
