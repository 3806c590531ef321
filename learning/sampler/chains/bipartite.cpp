#include "learning/sampler/chains/bipartite.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace gonogo::learning {
namespace {

/// 0 left, 1 right for each variable; nothing when two neighbours would share a side.
std::optional<std::vector<int>> two_colouring(const Problem& problem) {
  const std::size_t n = problem.variable_count();
  std::vector<std::vector<std::uint32_t>> neighbours(n);
  for (const Coupling& c : problem.couplings) {
    neighbours[c.a].push_back(c.b);
    neighbours[c.b].push_back(c.a);
  }
  std::vector<int> side(n, -1);
  std::vector<std::uint32_t> queue;
  for (std::uint32_t root = 0; root < n; ++root) {
    if (side[root] >= 0) continue;
    side[root] = neighbours[root].empty() ? 1 : 0;
    queue.assign(1, root);
    while (!queue.empty()) {
      const std::uint32_t i = queue.back();
      queue.pop_back();
      for (std::uint32_t j : neighbours[i]) {
        if (side[j] == side[i]) return std::nullopt;
        if (side[j] >= 0) continue;
        side[j] = 1 - side[i];
        queue.push_back(j);
      }
    }
  }
  return side;
}

}  // namespace

std::optional<Bipartite> split_in_two(const Problem& qubo) {
  GONOGO_ASSERT(qubo.vartype == Vartype::binary);
  const auto side = two_colouring(qubo);
  if (!side) return std::nullopt;
  Bipartite result;
  result.offset = qubo.offset;
  std::vector<std::size_t> place(qubo.variable_count());
  for (std::uint32_t i = 0; i < qubo.variable_count(); ++i) {
    auto& members = (*side)[i] == 0 ? result.left : result.right;
    place[i] = members.size();
    members.push_back(i);
    ((*side)[i] == 0 ? result.bias_left : result.bias_right).push_back(-qubo.linear[i]);
  }
  const std::size_t left = result.left.size(), right = result.right.size();
  result.weight.assign(left * right, 0);
  result.weight_transpose.assign(left * right, 0);
  for (const Coupling& c : qubo.couplings) {
    const std::size_t l = place[(*side)[c.a] == 0 ? c.a : c.b], r = place[(*side)[c.a] == 0 ? c.b : c.a];
    result.weight[l * right + r] = -c.value;
    result.weight_transpose[r * left + l] = -c.value;
  }
  return result;
}

void side_field(std::span<const std::uint8_t> from, std::span<const double> weight, std::span<const double> bias,
                std::span<double> field) {
  std::copy(bias.begin(), bias.end(), field.begin());
  const std::size_t width = field.size();
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (!from[i]) continue;
    const double* row = weight.data() + i * width;
    for (std::size_t j = 0; j < width; ++j) field[j] += row[j];
  }
}

void draw_bits(std::span<const double> field, ChainRandom& random, std::size_t first_unit, std::span<std::uint8_t> to) {
  for (std::size_t j = 0; j < to.size(); ++j) {
    const double u = random(first_unit + j);
    to[j] = u * (1 + std::exp(-field[j])) < 1;
  }
}

}  // namespace gonogo::learning
