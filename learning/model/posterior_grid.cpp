// P(outcome) over a grid of two variables, such as the slopes along and across a heading.
//
// With all other variables known, exp(-field) of a node is a product of three parts: one of the point, one of the row
// and one of the column. So the whole grid takes rows + columns exponentials instead of rows x columns, and all points
// of a grid share those (PreparedGrid).
//
// Where variables are unknown, a node is a sum over thousands of combinations. Fields are linear in both variables
// between the middles of their bins, so that P(outcome) is analytic there. On each patch between middles it is
// interpolated by a polynomial
//
//   sum over (i, j) of w_ij h_i(s) h_j(t)      s, t in [0, 1]
//
// in the terms of leja.h. A term is nowhere larger than its surplus w_ij, and takes the value at one more node. Terms
// are added where they may matter by those before them (GridPatch::expected()), until the rest is below kGridError. A
// patch with fewer nodes of the grid than that would take is summed node by node.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "base/error.h"
#include "base/parallel/host_loop.h"
#include "learning/model/leja.h"
#include "learning/model/posterior.h"
#include "learning/model/posterior_parts.h"

namespace gonogo::learning {
namespace {

/// The values of one variable that lie between the same two middles of its bins, or at one middle.
struct Piece {
  static constexpr int kNodes = kLejaCount - 1;  // of a piece without its end, which is the next one's start
  int first = 0;                                 // node of its start, kNodes to a piece
  bool is_point = false;                         // all values lie at the start
  std::vector<std::size_t> values;               // places in the grid

  /// Number of the node at a Leja point of the piece.
  int node(int k) const { return first + (k == 0 ? 0 : k == 1 ? kNodes : k - 1); }
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
      Piece& piece = pieces.try_emplace(left, Piece{left * Piece::kNodes, true, {}}).first->second;
      piece.is_point = piece.is_point && share == 0;
      piece.values.push_back(i);
    }
    for (auto& [left, piece] : pieces) pieces_.push_back(std::move(piece));
  }

  const std::vector<Piece>& pieces() const { return pieces_; }
  int node_count() const { return int(middles_.size() - 1) * Piece::kNodes + 1; }
  /// The variable at a node.
  double at(int node) const {
    const int left = node / Piece::kNodes, k = node % Piece::kNodes;
    return k == 0 ? middle(left) : middle(left) + leja_point(k + 1) * (middle(left + 1) - middle(left));
  }
  /// The first `count` terms at the value at place i.
  std::vector<double> terms(std::size_t i, int count) const {
    std::vector<double> terms(std::size_t(count), 0.0);
    leja_terms(share_[i], terms);
    return terms;
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

/// A term of a patch's polynomial.
struct GridTerm {
  int i = 0, j = 0;
};

/// A piece of one axis by a piece of the other, with its polynomial.
class GridPatch {
 public:
  GridPatch(const Piece& first, const Piece& second, std::size_t outcomes)
      : first_(&first), second_(&second), outcomes_(outcomes) {
    for (auto& row : size_) row.fill(kNone);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3 && i + j < 4; ++j)
        if (is_term(i, j)) wanted_.push_back({i, j});
    summed_ = wanted_.size() >= grid_nodes();
  }

  const Piece& first() const { return *first_; }
  const Piece& second() const { return *second_; }
  std::size_t grid_nodes() const { return first_->values.size() * second_->values.size(); }
  /// Whether it is summed node by node of the grid.
  bool is_summed() const { return summed_; }
  /// Terms whose nodes are to be computed next; none: the polynomial is fine enough.
  const std::vector<GridTerm>& wanted() const { return wanted_; }
  int first_terms() const { return 1 + most(&GridTerm::i); }
  int second_terms() const { return 1 + most(&GridTerm::j); }

  /// Adds the wanted terms. value(i, j): the function at a node [outcome]. Each needs those with smaller numbers.
  template <class Value>
  void add_wanted(const Value& value) {
    for (const GridTerm& t : wanted_) {
      const double* here = value(t.i, t.j);
      std::vector<double> terms_i(std::size_t(t.i) + 1), terms_j(std::size_t(t.j) + 1), rest(here, here + outcomes_);
      leja_terms(leja_point(t.i), terms_i);
      leja_terms(leja_point(t.j), terms_j);
      for (std::size_t k = 0; k < terms_.size(); ++k) {
        if (terms_[k].i > t.i || terms_[k].j > t.j) continue;
        const double factor = terms_i[std::size_t(terms_[k].i)] * terms_j[std::size_t(terms_[k].j)];
        for (std::size_t o = 0; o < outcomes_; ++o) rest[o] -= factor * surplus_[k * outcomes_ + o];
      }
      terms_.push_back(t);
      surplus_.insert(surplus_.end(), rest.begin(), rest.end());
      double& size = size_[std::size_t(t.i)][std::size_t(t.j)] = 0;
      for (const double w : rest) size = std::max(size, std::abs(w));
    }
    choose_next();
  }

  /// line[j][o]: the polynomial's coefficients in the second variable, where the first one has these terms.
  void reduce(std::span<const double> terms_i, std::span<double> line) const {
    std::fill(line.begin(), line.end(), 0.0);
    for (std::size_t k = 0; k < terms_.size(); ++k)
      for (std::size_t o = 0; o < outcomes_; ++o)
        line[std::size_t(terms_[k].j) * outcomes_ + o] +=
            terms_i[std::size_t(terms_[k].i)] * surplus_[k * outcomes_ + o];
  }

 private:
  static constexpr double kNone = -1;               // no such term yet
  static constexpr double kDecay = 0.5;             // of a term from the one before it
  static constexpr double kLeft = kGridError / 16;  // a term may be left out where it may be as large as this

  bool is_term(int i, int j) const { return (i == 0 || !first_->is_point) && (j == 0 || !second_->is_point); }
  double size(int i, int j) const { return size_[std::size_t(i)][std::size_t(j)]; }
  int most(int GridTerm::*number) const {
    int most = 0;
    for (const GridTerm& t : terms_) most = std::max(most, t.*number);
    return most;
  }

  /// What a term may be by the two before it in one direction. Two, because every other one of a function that is odd
  /// about the middle vanishes.
  static double next_of(double before, double before_that) { return kDecay * std::max(before, kDecay * before_that); }
  /// What a term may be, by the direction in which more is to be expected.
  double expected(int i, int j) const {
    double most = 0;
    if (i > 0) most = std::max(most, i == 1 ? size(0, j) : next_of(size(i - 1, j), i > 2 ? size(i - 2, j) : 0));
    if (j > 0) most = std::max(most, j == 1 ? size(i, 0) : next_of(size(i, j - 1), j > 2 ? size(i, j - 2) : 0));
    return most;
  }

  void choose_next() {
    wanted_.clear();
    bool is_full = false;
    for (int i = 0; i <= kLejaCount; ++i)
      for (int j = 0; j <= kLejaCount; ++j) {
        if (!is_term(i, j) || size(i, j) != kNone) continue;
        if ((i > 0 && size(i - 1, j) == kNone) || (j > 0 && size(i, j - 1) == kNone)) continue;
        if (expected(i, j) <= kLeft) continue;
        wanted_.push_back({i, j});
        is_full = is_full || i == kLejaCount || j == kLejaCount;
      }
    summed_ = is_full || (!wanted_.empty() && terms_.size() + wanted_.size() >= grid_nodes());
  }

  const Piece *first_, *second_;
  std::size_t outcomes_;
  bool summed_ = false;
  std::vector<GridTerm> wanted_, terms_;
  std::vector<double> surplus_;                                          // [term][outcome]
  std::array<std::array<double, kLejaCount + 1>, kLejaCount + 1> size_;  // [i][j] largest surplus, or kNone
};

/// Interpolates `near(x, y)`, the probabilities at values of both variables; `exact(x, y)` are the same where a patch
/// is summed node by node.
template <class Near, class Exact>
class GridInterpolation {
 public:
  GridInterpolation(const GridAxis& first, const GridAxis& second, const VariableGrid& grid, std::size_t outcomes,
                    const Near& near, const Exact& exact)
      : first_(first), second_(second), grid_(grid), outcomes_(outcomes), near_(near), exact_(exact) {
    slot_.assign(std::size_t(first.node_count()) * std::size_t(second.node_count()), -1);
    for (const Piece& a : first.pieces())
      for (const Piece& b : second.pieces()) patches_.emplace_back(a, b, outcomes);
  }

  void operator()(std::span<double> result) {
    for (;;) {
      std::vector<std::size_t> open;
      for (std::size_t p = 0; p < patches_.size(); ++p)
        if (!patches_[p].is_summed() && !patches_[p].wanted().empty()) open.push_back(p);
      if (open.empty()) break;
      compute_nodes(open);
      for_each_on_host(open.size(), 1, [&](std::size_t k) {
        GridPatch& patch = patches_[open[k]];
        patch.add_wanted([&](int i, int j) { return value_.data() + std::size_t(slot(patch, {i, j})) * outcomes_; });
      });
    }
    sum_directly(result);
    for_each_on_host(patches_.size(), 1, [&](std::size_t p) {
      if (!patches_[p].is_summed()) interpolate(patches_[p], result);
    });
  }

 private:
  int& slot(const GridPatch& p, GridTerm term) {
    return slot_[std::size_t(p.first().node(term.i)) * std::size_t(second_.node_count()) +
                 std::size_t(p.second().node(term.j))];
  }

  void compute_nodes(const std::vector<std::size_t>& open) {
    std::vector<std::pair<int, int>> missing;
    for (const std::size_t index : open)
      for (const GridTerm term : patches_[index].wanted()) {
        int& at = slot(patches_[index], term);
        if (at >= 0) continue;
        at = int(value_.size() / outcomes_ + missing.size());
        missing.emplace_back(patches_[index].first().node(term.i), patches_[index].second().node(term.j));
      }
    const std::size_t before = value_.size();
    value_.resize(before + missing.size() * outcomes_);
    for_each_on_host(missing.size(), 1, [&](std::size_t i) {
      near_(first_.at(missing[i].first), second_.at(missing[i].second),
            std::span(value_).subspan(before + i * outcomes_, outcomes_));
    });
  }

  std::span<double> answer(std::size_t a, std::size_t b, std::span<double> result) const {
    return result.subspan((a * grid_.second_values.size() + b) * outcomes_, outcomes_);
  }

  void sum_directly(std::span<double> result) const {
    std::vector<std::pair<std::size_t, std::size_t>> nodes;
    for (const GridPatch& p : patches_)
      for (const std::size_t a : p.first().values)
        for (const std::size_t b : p.second().values)
          if (p.is_summed()) nodes.emplace_back(a, b);
    for_each_on_host(nodes.size(), 1, [&](std::size_t i) {
      const auto [a, b] = nodes[i];
      exact_(grid_.first_values[a], grid_.second_values[b], answer(a, b, result));
    });
  }

  void interpolate(const GridPatch& p, std::span<double> result) const {
    std::vector<std::vector<double>> of_second;
    for (const std::size_t b : p.second().values) of_second.push_back(second_.terms(b, p.second_terms()));
    std::vector<double> line(std::size_t(p.second_terms()) * outcomes_);
    for (const std::size_t a : p.first().values) {
      p.reduce(first_.terms(a, p.first_terms()), line);
      for (std::size_t n = 0; n < p.second().values.size(); ++n) {
        const std::span<double> at = answer(a, p.second().values[n], result);
        std::fill(at.begin(), at.end(), 0.0);
        for (std::size_t j = 0; j < of_second[n].size(); ++j)
          for (std::size_t o = 0; o < outcomes_; ++o) at[o] += of_second[n][j] * line[j * outcomes_ + o];
        double total = 0;
        for (double& x : at) total += x = std::max(0.0, x);
        for (double& x : at) x /= total;
      }
    }
  }

  const GridAxis &first_, &second_;
  const VariableGrid& grid_;
  std::size_t outcomes_;
  const Near& near_;
  const Exact& exact_;
  std::vector<GridPatch> patches_;
  std::vector<int> slot_;      // [node of first][node of second] in value_; -1: not computed
  std::vector<double> value_;  // [slot][outcome]
};

}  // namespace

PreparedGrid Posterior::prepared(const VariableGrid& grid) const {
  const std::size_t hidden = hidden_bias_.size(), columns = grid.second_values.size();
  PreparedGrid result{.grid = grid, .lowest = std::vector(hidden, 0.0), .highest = std::vector(hidden, 0.0)};
  const auto add = [&](std::size_t variable, std::span<const double> values, std::vector<double>& fields) {
    fields.assign(values.size() * hidden, 0.0);
    for (std::size_t i = 0; i < values.size(); ++i)
      add_field(nodes_[variable], values[i], std::span(fields).subspan(i * hidden, hidden));
    for (std::size_t j = 0; j < hidden; ++j) {
      double least = INFINITY, most = -INFINITY;
      for (std::size_t at = j; at < fields.size(); at += hidden) {
        least = std::min(least, fields[at]);
        most = std::max(most, fields[at]);
      }
      result.lowest[j] += least;
      result.highest[j] += most;
      result.fits = result.fits && std::abs(least) < kMaxLog / 4 && std::abs(most) < kMaxLog / 4;
    }
  };
  add(grid.first, grid.first_values, result.first_field);
  add(grid.second, grid.second_values, result.second_field);
  if (!result.fits) return result;
  for (const double field : result.first_field) result.first_inverse.push_back(std::exp(-field));
  result.second_inverse.assign((columns + kLanes - 1) / kLanes * hidden * kLanes, 1.0);
  for (std::size_t i = 0; i < columns; ++i)
    for (std::size_t j = 0; j < hidden; ++j)
      result.second_inverse[(i / kLanes * hidden + j) * kLanes + i % kLanes] =
          std::exp(-result.second_field[i * hidden + j]);
  return result;
}

void Posterior::known_on_grid(std::span<const double> field, const PreparedGrid& prepared,
                              std::span<double> result) const {
  const std::size_t hidden = field.size(), outcomes = outcome_count();
  const std::size_t rows = prepared.grid.first_values.size(), columns = prepared.grid.second_values.size();
  bool fits = prepared.fits;
  std::vector<double> lowest = prepared.lowest, highest = prepared.highest, own(hidden);
  for (std::size_t j = 0; j < hidden; ++j) {
    lowest[j] += field[j];
    highest[j] += field[j];
    own[j] = std::exp(-field[j]);
    fits = fits && std::abs(field[j]) < kMaxLog / 4;
  }
  if (!fits || !products_.fit(lowest, highest, kMaxLog)) {
    std::vector<double> at(hidden);
    for (std::size_t n = 0; n < rows * columns; ++n) {
      for (std::size_t j = 0; j < hidden; ++j)
        at[j] =
            field[j] + prepared.first_field[n / columns * hidden + j] + prepared.second_field[n % columns * hidden + j];
      outcome_shares(at, result.subspan(n * outcomes, outcomes));
    }
    return;
  }
  const std::size_t block_size = hidden * kLanes, blocks = prepared.second_inverse.size() / block_size;
  std::vector<double> common(hidden), product(products_.padded_outcomes() * kLanes);
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t j = 0; j < hidden; ++j) common[j] = own[j] * prepared.first_inverse[row * hidden + j];
    for (std::size_t block = 0; block < blocks; ++block) {
      products_(common, std::span(prepared.second_inverse).subspan(block * block_size, block_size), product);
      for (std::size_t l = 0; l < std::min(kLanes, columns - block * kLanes); ++l) {
        double* at = result.data() + (row * columns + block * kLanes + l) * outcomes;
        double total = 0;
        for (std::size_t y = 0; y < outcomes; ++y) total += product[y * kLanes + l];
        for (std::size_t y = 0; y < outcomes; ++y) at[y] = product[y * kLanes + l] / total;
      }
    }
  }
}

void Posterior::on_prepared(std::span<const double> variables, const PreparedGrid& prepared,
                            std::span<double> result) const {
  const VariableGrid& grid = prepared.grid;
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
  if (unknown.empty()) return known_on_grid(field, prepared, result);
  const bool exact = terms <= double(MarginalOptions().max_terms);
  const Summation plan = exact ? summation(unknown) : Summation{};
  const auto sum = [&](double x, double y, Precision precision, std::span<double> answer) {
    std::vector<double> at = field;
    add_field(nodes_[grid.first], x, at);
    add_field(nodes_[grid.second], y, at);
    std::optional<PosteriorAnswer> found = exact ? sum_products(at, plan, precision) : std::nullopt;
    if (!found && exact) found = sum_logarithms(at, unknown);
    if (!found) {
      std::vector<double> point(variables.begin(), variables.end());
      point[grid.first] = x;
      point[grid.second] = y;
      found = joint(point, std::nullopt).outcome;
    }
    std::copy(found->probability.begin(), found->probability.end(), answer.begin());
  };
  const auto near = [&](double x, double y, std::span<double> answer) { sum(x, y, Precision::single, answer); };
  const auto full = [&](double x, double y, std::span<double> answer) { sum(x, y, Precision::full, answer); };
  GONOGO_ASSERT(nodes_[grid.first].smooth && nodes_[grid.second].smooth);
  const GridAxis first(nodes_[grid.first].middle, grid.first_values),
      second(nodes_[grid.second].middle, grid.second_values);
  GridInterpolation interpolation(first, second, grid, outcome_count(), near, full);
  interpolation(result);
}

}  // namespace gonogo::learning
