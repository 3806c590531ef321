// P(outcome) over a grid of two variables, such as the slopes along and across a heading.
//
// With all other variables known, exp(-field) of a node is a product of three parts: one of the point, one of the row
// and one of the column. So the whole grid takes rows + columns exponentials instead of rows x columns.
//
// Where variables are unknown, a node is a sum over thousands of combinations. Fields are linear in both variables
// between the middles of their bins, so that P(outcome) is analytic there. It is interpolated by polynomials through
// Chebyshev-Lobatto nodes of each patch between middles. Degrees double until the last Chebyshev coefficients fall
// below kGridError; a patch with fewer nodes of the grid than that would take is summed node by node.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/error.h"
#include "base/parallel/host_loop.h"
#include "base/units.h"
#include "learning/model/posterior.h"
#include "learning/model/posterior_parts.h"

namespace gonogo::learning {
namespace {

constexpr int kLeast = 4, kMost = 16;  // degrees of polynomials

/// Place of the k-th of the n + 1 Chebyshev-Lobatto nodes in [0, 1], rising.
double lobatto(int k, int n) { return (1 - std::cos(kPi * k / n)) / 2; }

/// Weights of the values at the n + 1 nodes for the value at t in [0, 1]: barycentric interpolation (Berrut &
/// Trefethen 2004, eq. 5.4).
std::vector<double> interpolation_weights(double t, int n) {
  std::vector<double> weight(std::size_t(n) + 1, 0.0);
  double sum = 0;
  for (int k = 0; k <= n; ++k) {
    const double distance = t - lobatto(k, n);
    if (distance == 0) {
      std::fill(weight.begin(), weight.end(), 0.0);
      weight[std::size_t(k)] = 1;
      return weight;
    }
    weight[std::size_t(k)] = (k % 2 ? -1 : 1) * (k == 0 || k == n ? 0.5 : 1) / distance;
    sum += weight[std::size_t(k)];
  }
  for (double& w : weight) w /= sum;
  return weight;
}

/// The larger size of the last two Chebyshev coefficients of the polynomial through values at the n + 1 nodes.
double tail(std::span<const double> value) {
  const int n = int(value.size()) - 1;
  double most = 0;
  for (int m = n - 1; m <= n; ++m) {
    double sum = 0;
    for (int k = 0; k <= n; ++k)
      sum += (k == 0 || k == n ? 0.5 : 1) * value[std::size_t(k)] * std::cos(kPi * m * k / n);
    most = std::max(most, std::abs(sum) * (m == n ? 1.0 : 2.0) / n);
  }
  return most;
}

/// The values of one variable that lie between the same two middles of its bins, or at one middle.
struct Piece {
  int first = 0;                    // node of its start, kMost nodes to a piece
  bool is_point = false;            // all values lie at the start
  std::vector<std::size_t> values;  // places in the grid
};

/// One variable of a grid.
class GridAxis {
 public:
  GridAxis(const std::vector<double>& middles, std::span<const double> values) : middles_(middles) {
    std::map<int, Piece> pieces;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const int left = left_middle(values[i]);
      const double share =
          middles.size() < 2 ? 0 : std::clamp((values[i] - middle(left)) / (middle(left + 1) - middle(left)), 0.0, 1.0);
      share_.push_back(share);
      Piece& piece = pieces.try_emplace(left, Piece{left * kMost, true, {}}).first->second;
      piece.is_point = piece.is_point && share == 0;
      piece.values.push_back(i);
    }
    for (auto& [left, piece] : pieces) pieces_.push_back(std::move(piece));
  }

  const std::vector<Piece>& pieces() const { return pieces_; }
  int node_count() const { return int(middles_.size() - 1) * kMost + 1; }
  /// The variable at a node.
  double at(int node) const {
    const int left = std::min(node / kMost, std::max(0, int(middles_.size()) - 2));
    if (node == left * kMost) return middle(left);
    return middle(left) + lobatto(node - left * kMost, kMost) * (middle(left + 1) - middle(left));
  }
  /// Weights of the nodes of a piece for the value at place i.
  std::vector<double> weights(std::size_t i, int degree) const {
    return degree == 0 ? std::vector<double>{1.0} : interpolation_weights(share_[i], degree);
  }

 private:
  double middle(int i) const { return middles_[std::size_t(i)]; }
  /// The middle below a value; the first or last but one for values beyond the ends.
  int left_middle(double value) const {
    if (middles_.size() < 3) return 0;
    return int(std::upper_bound(middles_.begin() + 1, middles_.end() - 1, value) - middles_.begin()) - 1;
  }

  const std::vector<double>& middles_;
  std::vector<double> share_;  // [value] of the way from the left middle to the right one
  std::vector<Piece> pieces_;
};

/// A piece of one axis by a piece of the other.
struct Patch {
  const Piece *first, *second;
  int first_degree, second_degree;  // 0 at a point
  bool summed = false;              // node by node of the grid

  std::size_t grid_nodes() const { return first->values.size() * second->values.size(); }
  static int node(const Piece& piece, int degree, int k) {
    return piece.first + (degree == 0 ? 0 : k * (kMost / degree));
  }
};

/// Interpolates `sum(x, y)`, the probabilities at values of both variables.
template <class Sum>
class GridInterpolation {
 public:
  GridInterpolation(const GridAxis& first, const GridAxis& second, const VariableGrid& grid, std::size_t outcomes,
                    const Sum& sum)
      : first_(first), second_(second), grid_(grid), outcomes_(outcomes), sum_(sum) {
    slot_.assign(std::size_t(first.node_count()) * std::size_t(second.node_count()), -1);
    for (const Piece& a : first.pieces())
      for (const Piece& b : second.pieces()) {
        Patch patch{&a, &b, a.is_point ? 0 : kLeast, b.is_point ? 0 : kLeast};
        patch.summed = size_of(patch) >= patch.grid_nodes();
        patches_.push_back(patch);
      }
  }

  void operator()(std::span<double> result) {
    std::vector<std::size_t> open;
    for (std::size_t p = 0; p < patches_.size(); ++p)
      if (!patches_[p].summed) open.push_back(p);
    while (!open.empty()) {
      compute_nodes(open);
      std::vector<char> refined(open.size(), 0);
      for_each_on_host(open.size(), 1, [&](std::size_t i) { refined[i] = char(refine(patches_[open[i]])); });
      std::vector<std::size_t> next;
      for (std::size_t i = 0; i < open.size(); ++i)
        if (refined[i] && !patches_[open[i]].summed) next.push_back(open[i]);
      open = std::move(next);
    }
    sum_directly(result);
    for_each_on_host(patches_.size(), 1, [&](std::size_t p) {
      if (!patches_[p].summed) interpolate(patches_[p], result);
    });
  }

 private:
  static std::size_t size_of(const Patch& p) {
    return std::size_t(p.first_degree + 1) * std::size_t(p.second_degree + 1);
  }
  std::size_t place(int a, int b) const { return std::size_t(a) * std::size_t(second_.node_count()) + std::size_t(b); }
  const double* value(const Patch& p, int i, int k) const {
    const int a = Patch::node(*p.first, p.first_degree, i), b = Patch::node(*p.second, p.second_degree, k);
    return value_.data() + std::size_t(slot_[place(a, b)]) * outcomes_;
  }

  void compute_nodes(const std::vector<std::size_t>& open) {
    std::vector<std::pair<int, int>> missing;
    for (const std::size_t index : open) {
      const Patch& p = patches_[index];
      for (int i = 0; i <= p.first_degree; ++i)
        for (int k = 0; k <= p.second_degree; ++k) {
          const int a = Patch::node(*p.first, p.first_degree, i), b = Patch::node(*p.second, p.second_degree, k);
          int& slot = slot_[place(a, b)];
          if (slot >= 0) continue;
          slot = int(value_.size() / outcomes_ + missing.size());
          missing.emplace_back(a, b);
        }
    }
    const std::size_t before = value_.size();
    value_.resize(before + missing.size() * outcomes_);
    for_each_on_host(missing.size(), 1, [&](std::size_t i) {
      sum_(first_.at(missing[i].first), second_.at(missing[i].second),
           std::span(value_).subspan(before + i * outcomes_, outcomes_));
    });
  }

  /// Doubles the degrees in which the error is too large. Whether it did.
  bool refine(Patch& p) const {
    double along_first = 0, along_second = 0;
    std::vector<double> line;
    for (std::size_t o = 0; o < outcomes_; ++o) {
      for (int k = 0; k <= p.second_degree && p.first_degree > 0; ++k) {
        line.clear();
        for (int i = 0; i <= p.first_degree; ++i) line.push_back(value(p, i, k)[o]);
        along_first = std::max(along_first, tail(line));
      }
      for (int i = 0; i <= p.first_degree && p.second_degree > 0; ++i) {
        line.clear();
        for (int k = 0; k <= p.second_degree; ++k) line.push_back(value(p, i, k)[o]);
        along_second = std::max(along_second, tail(line));
      }
    }
    const bool first = along_first > kGridError, second = along_second > kGridError;
    if (!first && !second) return false;
    if (first) p.first_degree *= 2;
    if (second) p.second_degree *= 2;
    p.summed = p.first_degree > kMost || p.second_degree > kMost || size_of(p) >= p.grid_nodes();
    return true;
  }

  std::span<double> answer(std::size_t a, std::size_t b, std::span<double> result) const {
    return result.subspan((a * grid_.second_values.size() + b) * outcomes_, outcomes_);
  }

  void sum_directly(std::span<double> result) const {
    std::vector<std::pair<std::size_t, std::size_t>> nodes;
    for (const Patch& p : patches_)
      for (const std::size_t a : p.first->values)
        for (const std::size_t b : p.second->values)
          if (p.summed) nodes.emplace_back(a, b);
    for_each_on_host(nodes.size(), 1, [&](std::size_t i) {
      const auto [a, b] = nodes[i];
      sum_(grid_.first_values[a], grid_.second_values[b], answer(a, b, result));
    });
  }

  void interpolate(const Patch& p, std::span<double> result) const {
    std::vector<std::vector<double>> of_second;
    for (const std::size_t b : p.second->values) of_second.push_back(second_.weights(b, p.second_degree));
    std::vector<double> line(std::size_t(p.second_degree + 1) * outcomes_);
    for (const std::size_t a : p.first->values) {
      const std::vector<double> of_first = first_.weights(a, p.first_degree);
      std::fill(line.begin(), line.end(), 0.0);
      for (int k = 0; k <= p.second_degree; ++k)
        for (int i = 0; i <= p.first_degree; ++i)
          for (std::size_t o = 0; o < outcomes_; ++o)
            line[std::size_t(k) * outcomes_ + o] += of_first[std::size_t(i)] * value(p, i, k)[o];
      for (std::size_t n = 0; n < p.second->values.size(); ++n) {
        const std::span<double> at = answer(a, p.second->values[n], result);
        std::fill(at.begin(), at.end(), 0.0);
        for (std::size_t k = 0; k < of_second[n].size(); ++k)
          for (std::size_t o = 0; o < outcomes_; ++o) at[o] += of_second[n][k] * line[k * outcomes_ + o];
        double total = 0;
        for (double& x : at) total += x = std::max(0.0, x);
        for (double& x : at) x /= total;
      }
    }
  }

  const GridAxis &first_, &second_;
  const VariableGrid& grid_;
  std::size_t outcomes_;
  const Sum& sum_;
  std::vector<Patch> patches_;
  std::vector<int> slot_;      // [node of first][node of second] in value_; -1: not computed
  std::vector<double> value_;  // [slot][outcome]
};

}  // namespace

void Posterior::known_on_grid(std::span<const double> field, const VariableGrid& grid, std::span<double> result) const {
  const std::size_t hidden = field.size(), outcomes = outcome_count();
  const std::size_t rows = grid.first_values.size(), columns = grid.second_values.size();
  const auto fields_of = [&](std::size_t variable, std::span<const double> values) {
    std::vector<double> fields(values.size() * hidden, 0.0);
    for (std::size_t i = 0; i < values.size(); ++i)
      add_field(nodes_[variable], values[i], std::span(fields).subspan(i * hidden, hidden));
    return fields;
  };
  const std::vector<double> of_row = fields_of(grid.first, grid.first_values),
                            of_column = fields_of(grid.second, grid.second_values);
  bool fits = true;
  std::vector<double> lowest(field.begin(), field.end()), highest = lowest;
  for (std::size_t j = 0; j < hidden; ++j) {
    for (const auto& [fields, count] : {std::pair(&of_row, rows), std::pair(&of_column, columns)}) {
      double least = INFINITY, most = -INFINITY;
      for (std::size_t i = 0; i < count; ++i) {
        least = std::min(least, (*fields)[i * hidden + j]);
        most = std::max(most, (*fields)[i * hidden + j]);
      }
      lowest[j] += least;
      highest[j] += most;
      fits = fits && std::abs(least) < kMaxLog / 4 && std::abs(most) < kMaxLog / 4;
    }
    fits = fits && std::abs(field[j]) < kMaxLog / 4;
  }
  if (!fits || !products_.fit(lowest, highest, kMaxLog)) {
    std::vector<double> at(hidden);
    for (std::size_t n = 0; n < rows * columns; ++n) {
      for (std::size_t j = 0; j < hidden; ++j)
        at[j] = field[j] + of_row[n / columns * hidden + j] + of_column[n % columns * hidden + j];
      outcome_shares(at, result.subspan(n * outcomes, outcomes));
    }
    return;
  }
  const std::size_t blocks = (columns + kLanes - 1) / kLanes;
  std::vector<double> inverse(blocks * hidden * kLanes, 1.0), common(hidden),
      product(products_.padded_outcomes() * kLanes);
  for (std::size_t i = 0; i < columns; ++i)
    for (std::size_t j = 0; j < hidden; ++j)
      inverse[(i / kLanes * hidden + j) * kLanes + i % kLanes] = std::exp(-of_column[i * hidden + j]);
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t j = 0; j < hidden; ++j) common[j] = std::exp(-(field[j] + of_row[row * hidden + j]));
    for (std::size_t block = 0; block < blocks; ++block) {
      products_(common, std::span(inverse).subspan(block * hidden * kLanes, hidden * kLanes), product);
      for (std::size_t l = 0; l < std::min(kLanes, columns - block * kLanes); ++l) {
        double* at = result.data() + (row * columns + block * kLanes + l) * outcomes;
        double total = 0;
        for (std::size_t y = 0; y < outcomes; ++y) total += product[y * kLanes + l];
        for (std::size_t y = 0; y < outcomes; ++y) at[y] = product[y * kLanes + l] / total;
      }
    }
  }
}

void Posterior::on_grid(std::span<const double> variables, const VariableGrid& grid, std::span<double> result) const {
  GONOGO_ASSERT(variables.size() == nodes_.size() && grid.first != grid.second);
  GONOGO_ASSERT(result.size() == grid.first_values.size() * grid.second_values.size() * outcome_count());
  if (result.empty()) return;
  std::vector<double> field = hidden_bias_;
  std::vector<std::size_t> unknown;
  double terms = 1;
  for (std::size_t v = 0; v < nodes_.size(); ++v) {
    if (v == grid.first || v == grid.second) continue;
    if (!std::isnan(variables[v])) {
      add_field(nodes_[v], variables[v], field);
    } else if (nodes_[v].unit_count > 0) {
      unknown.push_back(v);
      terms *= double(nodes_[v].middle.size());
    }
  }
  if (unknown.empty()) return known_on_grid(field, grid, result);
  const bool exact = terms <= double(MarginalOptions().max_terms);
  const Summation plan = exact ? summation(unknown) : Summation{};
  const auto sum = [&](double x, double y, std::span<double> answer) {
    std::vector<double> at = field;
    add_field(nodes_[grid.first], x, at);
    add_field(nodes_[grid.second], y, at);
    std::optional<PosteriorAnswer> found = exact ? sum_products(at, plan) : std::nullopt;
    if (!found && exact) found = sum_logarithms(at, unknown);
    if (!found) {
      std::vector<double> point(variables.begin(), variables.end());
      point[grid.first] = x;
      point[grid.second] = y;
      found = joint(point, std::nullopt).outcome;
    }
    std::copy(found->probability.begin(), found->probability.end(), answer.begin());
  };
  GONOGO_ASSERT(nodes_[grid.first].smooth && nodes_[grid.second].smooth);
  const GridAxis first(nodes_[grid.first].middle, grid.first_values),
      second(nodes_[grid.second].middle, grid.second_values);
  GridInterpolation interpolation(first, second, grid, outcome_count(), sum);
  interpolation(result);
}

}  // namespace gonogo::learning
