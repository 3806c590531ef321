#include "learning/encoding/code_penalty.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.h"
#include "base/format.h"

namespace gonogo::learning {
namespace {

class Penalty {
 public:
  Penalty(const Problem& qubo, double strength) : result_(qubo), strength_(strength) {
    for (const Coupling& c : qubo.couplings) coupling_[{c.a, c.b}] = c.value;
  }

  void add(Code code, std::uint32_t first, std::uint32_t count) {
    if (code == Code::thermometer)
      add_order(first, count);
    else if (code == Code::one_hot && count > 0)
      add_one(first, count);
  }

  Problem problem() && {
    result_.couplings.clear();
    for (const auto& [pair, value] : coupling_) result_.couplings.push_back({pair.first, pair.second, value});
    return std::move(result_);
  }

 private:
  void add_order(std::uint32_t first, std::uint32_t count) {
    for (std::uint32_t k = 1; k < count; ++k) {
      result_.linear[first + k] += strength_;
      coupling_[{first + k - 1, first + k}] -= strength_;
    }
  }

  /// (1 - sum u)^2 = 1 - sum u + 2 sum_(a<b) u_a u_b, because u^2 = u.
  void add_one(std::uint32_t first, std::uint32_t count) {
    result_.offset += strength_;
    for (std::uint32_t a = 0; a < count; ++a) {
      result_.linear[first + a] -= strength_;
      for (std::uint32_t b = a + 1; b < count; ++b) coupling_[{first + a, first + b}] += 2 * strength_;
    }
  }

  Problem result_;
  double strength_;
  std::map<std::pair<std::uint32_t, std::uint32_t>, double> coupling_;
};

}  // namespace

Problem with_code_penalty(const Problem& qubo, const VisibleLayout& layout, std::span<const double> fixed,
                          double strength) {
  GONOGO_ASSERT(qubo.vartype == Vartype::binary && fixed.size() == qubo.variable_count() &&
                layout.unit_count() <= fixed.size());
  if (!std::isfinite(strength) || strength < 0)
    throw InputError("penalty of words that are no code words: " + number_text(strength) +
                     "; it must be an energy of at least 0 (0: none)");
  if (strength == 0) return qubo;
  Penalty penalty(qubo, strength);
  const auto add = [&](Code code, std::size_t first, std::size_t count) {
    const auto units = fixed.subspan(first, count);
    if (std::all_of(units.begin(), units.end(), [](double x) { return std::isnan(x); }))
      penalty.add(code, std::uint32_t(first), std::uint32_t(count));
  };
  for (std::size_t v = 0; v < layout.variable_count(); ++v)
    add(layout.encoders()[v].code(), layout.offset(v), layout.encoders()[v].unit_count());
  add(Code::one_hot, layout.input_unit_count(), layout.outcome_count());
  return std::move(penalty).problem();
}

}  // namespace gonogo::learning
