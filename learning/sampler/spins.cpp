#include "learning/sampler/spins.h"

#include <cmath>

#include "base/error.h"

namespace gonogo::learning {

SpinGraph::SpinGraph(const Problem& ising) : h(ising.linear), first(ising.variable_count() + 1, 0) {
  GONOGO_ASSERT(ising.vartype == Vartype::spin);
  for (const Coupling& c : ising.couplings) {
    ++first[c.a + 1];
    ++first[c.b + 1];
  }
  for (std::size_t i = 0; i < h.size(); ++i) first[i + 1] += first[i];
  std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
  neighbour.resize(2 * ising.couplings.size());
  J.resize(neighbour.size());
  for (const Coupling& c : ising.couplings) {
    neighbour[next[c.a]] = c.b;
    J[next[c.a]++] = c.value;
    neighbour[next[c.b]] = c.a;
    J[next[c.b]++] = c.value;
  }
}

void Spins::randomise(ChainRandom& random) {
  for (std::size_t i = 0; i < s_.size(); ++i) s_[i] = random(i) < 0.5 ? 1 : -1;
  refresh();
}

void Spins::refresh() {
  field_ = graph_->h;
  for (std::uint32_t i = 0; i < s_.size(); ++i)
    for (std::uint32_t k = graph_->first[i]; k < graph_->first[i + 1]; ++k)
      field_[i] += graph_->J[k] * s_[graph_->neighbour[k]];
}

void Spins::flip(std::uint32_t i) {
  s_[i] = std::int8_t(-s_[i]);
  for (std::uint32_t k = graph_->first[i]; k < graph_->first[i + 1]; ++k)
    field_[graph_->neighbour[k]] += 2 * graph_->J[k] * s_[i];
}

void Spins::sweep(double beta, ChainRandom& random) {
  constexpr double certain = 25;  // exp(-25) is below the resolution of the draws
  for (std::uint32_t i = 0; i < s_.size(); ++i) {
    const double x = 2 * beta * field_[i];
    const bool up = x > certain ? false : x < -certain ? true : random(i) * (1 + std::exp(x)) < 1;
    if (up != (s_[i] > 0)) flip(i);
  }
}

double Spins::energy() const {
  double sum = 0;
  for (std::size_t i = 0; i < s_.size(); ++i) sum += s_[i] * (field_[i] + graph_->h[i]) / 2;
  return sum;
}

SampleSet empty_rows(const Problem& problem, std::size_t reads) {
  SampleSet rows;
  rows.vartype = problem.vartype;
  rows.labels = problem.labels;
  rows.values.resize(reads * problem.variable_count());
  rows.energies.resize(reads);
  rows.occurrences.assign(reads, 1);
  return rows;
}

void set_row(SampleSet& rows, std::size_t r, const Problem& problem, std::span<const std::int8_t> spins) {
  const std::size_t n = problem.variable_count();
  const auto row = std::span(rows.values).subspan(r * n, n);
  for (std::size_t i = 0; i < n; ++i) row[i] = problem.vartype == Vartype::spin ? spins[i] : std::int8_t(spins[i] > 0);
  rows.energies[r] = energy(problem, row);
}

}  // namespace gonogo::learning
