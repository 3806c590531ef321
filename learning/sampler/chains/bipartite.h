// Bipartite problems: variables have two sides without couplings inside a side, so that given one side the variables of
// the other are independent. Storage is dense, as for restricted Boltzmann machines.
#pragma once
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "learning/qubo/problem.h"
#include "learning/sampler/chains/chain_random.h"

namespace gonogo::learning {

/// E(x) = offset - bias_left.l - bias_right.r - l' W r, x in {0, 1}, with the signs of a Boltzmann machine.
struct Bipartite {
  std::vector<std::uint32_t> left, right;  // indices of the variables in the problem
  std::vector<double> bias_left, bias_right;
  std::vector<double> weight;            // [left x right], row by row
  std::vector<double> weight_transpose;  // [right x left]
  double offset = 0;
};

/// Splits a problem in {0, 1} by a two-colouring; empty when it has an odd cycle. In each connected component the
/// lowest variable is on the left. Variables without couplings are on the right.
std::optional<Bipartite> split_in_two(const Problem& qubo);

/// bias + from' weight: the fields of one side given the bits of the other. weight: [from x field].
void side_field(std::span<const std::uint8_t> from, std::span<const double> weight, std::span<const double> bias,
                std::span<double> field);

/// Draws bits that are 1 with probability 1 / (1 + exp(-field)). Bit j uses random unit first_unit + j.
void draw_bits(std::span<const double> field, ChainRandom& random, std::size_t first_unit, std::span<std::uint8_t> to);

}  // namespace gonogo::learning
