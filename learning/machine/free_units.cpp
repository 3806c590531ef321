#include "learning/machine/free_units.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/math/random.h"
#include "base/progress.h"

namespace gonogo::learning {
namespace {

constexpr std::uint64_t kSeed = 0x66726565;
enum Stream : std::uint64_t { kStart = 1, kHidden = 2, kChosen = 3, kFree = 4, kBack = 5 };
constexpr std::size_t kChains = 256, kRungs = 5, kBurnIn = 100, kDraws = 32, kEvery = 5;  // rows of P
constexpr std::size_t kBatch = 192;                                                       // rows of P, and of Q, a step
constexpr std::size_t kSteps = 4000, kEvenSteps = 1200;
constexpr double kRate = 0.03, kLastRate = 0.001, kLargest = 3;  // difference of the exponents that a step weighs [nat]
constexpr double kCover = 0.3;  // share of the gradient of KL(P | Q), which keeps Q from missing rare rows of P

using Row = std::vector<std::uint32_t>;  // the hidden units that are on

/// The exponent of P.
double log_words(const WordMachine& machine, const Row& on, std::vector<double>& score) {
  score.assign(machine.word_bias().begin(), machine.word_bias().end());
  double result = 0;
  for (const std::uint32_t j : on) {
    result += machine.hidden_bias()[j];
    const auto add = machine.hidden_field(j);
    for (std::size_t w = 0; w < score.size(); ++w) score[w] += add[w];
  }
  for (const WordGroup& group : machine.groups())
    result += log_sum_exp(std::span(score).subspan(group.first, group.length));
  return result;
}

/// Hidden units of the machine, and how often each word occurs.
struct Drawn {
  std::vector<Row> rows;
  std::vector<double> share;  // [word]
};

Drawn drawn_rows(const WordMachine& machine) {
  WordChains chains(kChains, kRungs, kSeed);
  Drawn drawn{{}, std::vector<double>(machine.word_count(), 0.0)};
  for (std::size_t draw = 0; draw < kDraws; ++draw) {
    stop_if_cancelled();
    chains.run(machine, draw == 0 ? kBurnIn : kEvery);
    for (std::size_t c = 0; c < kChains; ++c) {
      std::vector<double> field(machine.hidden_bias().begin(), machine.hidden_bias().end());
      for (std::size_t g = 0; g < machine.groups().size(); ++g) {
        const std::size_t word = machine.groups()[g].first + chains.row(c)[g];
        drawn.share[word] += 1 / double(kDraws * kChains);
        for (std::size_t j = 0; j < field.size(); ++j) field[j] += machine.field(word)[j];
      }
      Row& row = drawn.rows.emplace_back();
      for (std::size_t j = 0; j < field.size(); ++j)
        if (random_unit(kSeed + kHidden, drawn.rows.size(), j) < sigmoid(field[j])) row.push_back(std::uint32_t(j));
    }
  }
  return drawn;
}

/// The parameters of Q in one list, so that the optimiser sees no difference: W' [hidden x unit], a', b'.
class Fit {
 public:
  Fit(const WordMachine& machine, std::size_t count, const Drawn& drawn)
      : hidden_(machine.hidden_count()), count_(count), value_(hidden_ * count + count + hidden_, 0.0) {
    for (std::size_t k = 0; k < hidden_ * count; ++k) value_[k] = 0.3 * random_normal(kSeed, kStart, k);
    // The slope of P's exponent where the words are as frequent as in its rows, less that of the free units at 0.
    for (std::size_t j = 0; j < hidden_; ++j) {
      double slope = machine.hidden_bias()[j];
      for (std::size_t w = 0; w < machine.word_count(); ++w) slope += drawn.share[w] * machine.field(w)[j];
      for (std::size_t k = 0; k < count; ++k) slope -= 0.5 * value_[j * count + k];
      hidden_bias(j) = slope;
    }
    first_.assign(value_.size(), 0.0);
    second_ = first_;
  }

  /// The exponent of Q; leaves the fields of the free units.
  double operator()(const Row& on, std::vector<double>& field) const {
    field.assign(value_.begin() + std::ptrdiff_t(hidden_ * count_),
                 value_.begin() + std::ptrdiff_t((hidden_ + 1) * count_));
    double result = 0;
    for (const std::uint32_t j : on) {
      result += value_[(hidden_ + 1) * count_ + j];
      for (std::size_t k = 0; k < count_; ++k) field[k] += value_[j * count_ + k];
    }
    for (const double x : field) result += softplus(x);
    return result;
  }

  /// One sweep of block Gibbs; leaves the fields of the free units before it.
  void sweep(Row& on, std::uint64_t chain, std::uint64_t number, std::vector<double>& field) const {
    (*this)(on, field);
    std::vector<double> back(value_.end() - std::ptrdiff_t(hidden_), value_.end());
    std::vector<char> is_on(count_);
    for (std::size_t k = 0; k < count_; ++k)
      is_on[k] = random_unit(kSeed + kFree, chain, number * count_ + k) < sigmoid(field[k]);
    for (std::size_t j = 0; j < hidden_; ++j)
      for (std::size_t k = 0; k < count_; ++k)
        if (is_on[k]) back[j] += value_[j * count_ + k];
    on.clear();
    for (std::size_t j = 0; j < hidden_; ++j)
      if (random_unit(kSeed + kBack, chain, number * hidden_ + j) < sigmoid(back[j])) on.push_back(std::uint32_t(j));
  }

  /// Adds `slope` times the gradient of the exponent at a row. field: of the free units.
  void add_gradient(const Row& on, const std::vector<double>& field, double slope,
                    std::vector<double>& gradient) const {
    std::vector<double> up(count_);
    for (std::size_t k = 0; k < count_; ++k) {
      up[k] = slope * sigmoid(field[k]);
      gradient[hidden_ * count_ + k] += up[k];
    }
    for (const std::uint32_t j : on) {
      gradient[(hidden_ + 1) * count_ + j] += slope;
      for (std::size_t k = 0; k < count_; ++k) gradient[j * count_ + k] += up[k];
    }
  }

  /// Adam (Kingma & Ba 2015), step 1, 2, ...
  void step(const std::vector<double>& gradient, std::size_t number, double rate) {
    constexpr double kFirst = 0.9, kSecond = 0.999, kSmall = 1e-10;
    const double first = 1 - std::pow(kFirst, double(number)), second = 1 - std::pow(kSecond, double(number));
    for (std::size_t k = 0; k < value_.size(); ++k) {
      first_[k] = kFirst * first_[k] + (1 - kFirst) * gradient[k];
      second_[k] = kSecond * second_[k] + (1 - kSecond) * gradient[k] * gradient[k];
      value_[k] -= rate * first_[k] / first / (std::sqrt(second_[k] / second) + kSmall);
    }
  }

  std::vector<double> zeros() const { return std::vector<double>(value_.size(), 0.0); }

  RbmWeights weights() const {
    RbmWeights result = RbmWeights::zeros(count_, hidden_);
    for (std::size_t k = 0; k < count_; ++k) {
      result.visible_bias[k] = value_[hidden_ * count_ + k];
      for (std::size_t j = 0; j < hidden_; ++j) result.weight[k * hidden_ + j] = value_[j * count_ + k];
    }
    result.hidden_bias.assign(value_.end() - std::ptrdiff_t(hidden_), value_.end());
    return result;
  }

 private:
  double& hidden_bias(std::size_t j) { return value_[(hidden_ + 1) * count_ + j]; }

  std::size_t hidden_, count_;
  std::vector<double> value_, first_, second_;  // parameters, running means of their gradients and of the squares
};

/// Rows of P, and then as many of Q, with the difference of the exponents of Q and P.
class Batch {
 public:
  Batch(const WordMachine& machine, const Drawn& drawn)
      : machine_(machine),
        drawn_(drawn),
        chains_(drawn.rows.end() - std::ptrdiff_t(kBatch), drawn.rows.end()),
        rows_(2 * kBatch),
        fields_(2 * kBatch),
        difference_(2 * kBatch) {
    for (const Row& row : drawn.rows) wanted_.push_back(log_words(machine, row, score_));
  }

  /// Draws the rows of step `number`.
  void draw(const Fit& fit, std::size_t number) {
    for (std::size_t n = 0; n < kBatch; ++n) {
      const auto chosen = std::size_t(random_unit(kSeed + kChosen, number, n) * double(drawn_.rows.size()));
      take(fit, n, drawn_.rows[chosen], wanted_[chosen]);
    }
    for (std::size_t n = kBatch; n < 2 * kBatch; ++n) {
      Row& row = chains_[n - kBatch];
      fit.sweep(row, n, number, fields_[n]);
      take(fit, n, row, log_words(machine_, row, score_));
    }
  }

  /// Of half the variance of the difference, and of `cover` times the divergence KL(P | Q).
  std::vector<double> gradient(const Fit& fit, double cover) const {
    double mean = 0;
    for (const double d : difference_) mean += d / double(2 * kBatch);
    std::vector<double> result = fit.zeros();
    for (std::size_t n = 0; n < 2 * kBatch; ++n) {
      const double slope = std::clamp(difference_[n] - mean, -kLargest, kLargest) + (n < kBatch ? -cover : cover);
      fit.add_gradient(*rows_[n], fields_[n], slope / double(2 * kBatch), result);
    }
    return result;
  }

 private:
  void take(const Fit& fit, std::size_t n, const Row& row, double exponent_of_p) {
    rows_[n] = &row;
    difference_[n] = fit(row, fields_[n]) - exponent_of_p;
  }

  const WordMachine& machine_;
  const Drawn& drawn_;
  std::vector<double> wanted_, score_;  // exponent of P at the drawn rows; scores of words
  std::vector<Row> chains_;             // of Q
  std::vector<const Row*> rows_;
  std::vector<std::vector<double>> fields_;  // of the free units
  std::vector<double> difference_;
};

}  // namespace

RbmWeights fitted_free_units(const WordMachine& machine, std::size_t count) {
  GONOGO_ASSERT(count > 0);
  const Drawn drawn = drawn_rows(machine);
  Fit fit(machine, count, drawn);
  Batch batch(machine, drawn);
  for (std::size_t number = 1; number <= kSteps; ++number) {
    stop_if_cancelled();
    batch.draw(fit, number);
    const double rate = kLastRate + (kRate - kLastRate) * (1 - double(number) / double(kSteps));
    fit.step(batch.gradient(fit, number <= kEvenSteps ? 0 : kCover), number, rate);
  }
  return fit.weights();
}

}  // namespace gonogo::learning
