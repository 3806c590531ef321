#include "learning/rbm/teaching_term.h"

#include <cmath>

#include "base/error.h"

namespace gonogo::learning {
namespace {

void check(const VisibleLayout& layout, const Teaching& teaching) {
  const std::size_t count = teaching.probability.size();
  if (count == 0 || teaching.points.size() != count * layout.variable_count() ||
      teaching.label.size() != layout.outcome_count())
    throw InputError("teacher: its points, probabilities and classes do not match the layout");
  for (double p : teaching.probability)
    if (!(p >= 0 && p <= 1)) throw InputError("teacher: " + std::to_string(p) + " is no probability");
  std::size_t ones = 0;
  for (int c : teaching.label) ones += c != 0;
  if (ones == 0 || ones == teaching.label.size())
    throw InputError("teacher: both classes need an outcome; the layout has those of one class only");
}

torch::Tensor mask(const std::vector<int>& label, int chosen) {
  std::vector<double> result;
  for (int c : label) result.push_back((c != 0) == (chosen != 0) ? 0.0 : -INFINITY);
  return torch::tensor(result, torch::kFloat64);
}

torch::Tensor smooth_units(const VisibleLayout& layout, const std::vector<double>& points) {
  const std::size_t variables = layout.variable_count(), units = layout.input_unit_count();
  const std::size_t count = points.size() / variables;
  torch::Tensor result = torch::empty({std::int64_t(count), std::int64_t(units)}, torch::kFloat64);
  for (std::size_t k = 0; k < count; ++k)
    layout.encode_smooth(std::span(points).subspan(k * variables, variables),
                         std::span(result.data_ptr<double>() + k * units, units));
  return result;
}

}  // namespace

TeachingTerm::TeachingTerm(const VisibleLayout& layout, const Teaching& teaching, torch::Device device)
    : weight_(teaching.weight) {
  check(layout, teaching);
  smooth_ = smooth_units(layout, teaching.points).to(device);
  probability_ = torch::tensor(teaching.probability, torch::kFloat64).to(device);
  passes_ = mask(teaching.label, 1).to(device);
  fails_ = mask(teaching.label, 0).to(device);
}

torch::Tensor TeachingTerm::over(const Machine& machine, const torch::Tensor& smooth,
                                 const torch::Tensor& probability) const {
  const torch::Tensor scores = negative_free_energy(machine, smooth), total = torch::logsumexp(scores, 1);
  const torch::Tensor passes = torch::logsumexp(scores + passes_, 1), fails = torch::logsumexp(scores + fails_, 1);
  return weight_ * (total - probability * passes - (1 - probability) * fails).mean();
}

torch::Tensor TeachingTerm::next(const Machine& machine, std::size_t count) {
  const std::int64_t points = smooth_.size(0), wanted = std::min(std::int64_t(count), points);
  if (next_ + wanted > points) next_ = 0;
  const std::int64_t first = next_;
  next_ += wanted;
  return over(machine, smooth_.slice(0, first, next_), probability_.slice(0, first, next_));
}

torch::Tensor TeachingTerm::all(const Machine& machine) const { return over(machine, smooth_, probability_); }

}  // namespace gonogo::learning
