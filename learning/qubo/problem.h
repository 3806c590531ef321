// Quadratic problems over two-valued variables, the input of annealers:
//
//   E(x) = offset + sum_i linear_i x_i + sum_(a<b) coupling_ab x_a x_b,   P(x) proportional to exp(-E(x))
//
// with x in {0, 1} (QUBO) or {-1, +1} (Ising). The vartype is part of the problem and never guessed.
#pragma once
#include <compare>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace gonogo::learning {

enum class Vartype { binary, spin };

std::string vartype_name(Vartype vartype);  // "BINARY", "SPIN": the names of dimod

struct LabelTuple;

/// Name of a variable in files: a whole number, a text, or another kind that dimod knows, a fraction or a tuple.
using Label = std::variant<std::int64_t, std::string, double, LabelTuple>;

struct LabelTuple {
  std::vector<Label> parts;
  std::partial_ordering operator<=>(const LabelTuple& other) const;
  bool operator==(const LabelTuple& other) const;
};

/// For people and for headers of tables; tuples as Python prints them: (0, (1, 'a')).
std::string label_text(const Label& label);

struct Coupling {
  std::uint32_t a = 0, b = 0;  // a < b
  double value = 0;
  bool operator==(const Coupling&) const = default;
};

struct Problem {
  Vartype vartype = Vartype::binary;
  std::vector<Label> labels{};        // [variable_count()], unique
  std::vector<double> linear{};       // [variable_count()]
  std::vector<Coupling> couplings{};  // sorted by (a, b), each pair once
  double offset = 0;

  std::size_t variable_count() const { return linear.size(); }
  bool operator==(const Problem&) const = default;
};

/// Sorts by (a, b); couplings of one pair keep their order.
void sort_couplings(std::vector<Coupling>& couplings);

/// Throws InputError for sizes that differ, values that are not finite, repeated labels, and couplings that are
/// unsorted, repeated, on the diagonal or out of range. Messages begin with `source`.
void check_problem(const Problem& problem, const std::string& source);

/// The same energies in the other vartype, s = 2 x - 1. Keeps couplings that become 0.
Problem to_vartype(const Problem& problem, Vartype vartype);
inline Problem to_ising(const Problem& qubo) { return to_vartype(qubo, Vartype::spin); }
inline Problem to_qubo(const Problem& ising) { return to_vartype(ising, Vartype::binary); }

/// row: [variable_count()] of {0, 1} or {-1, +1}, by the vartype.
double energy(const Problem& problem, std::span<const std::int8_t> row);

/// Removes the variables with a given value. values: [variable_count()], NaN for variables that stay; values between
/// those of the vartype are allowed. Energies do not change.
Problem clamp(const Problem& problem, std::span<const double> values);

}  // namespace gonogo::learning
