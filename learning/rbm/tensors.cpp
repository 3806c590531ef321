#include "learning/rbm/tensors.h"

#include <cmath>

#include "base/error.h"
#include "base/math/random.h"
#include "learning/rbm/words/word_gradient.h"

namespace gonogo::learning {
namespace {

constexpr std::size_t kMaxCompletions = 4096;  // of one row: more unknown variables say too little to be worth it

/// All code words of the unknown variables of a row, written over `smooth` and `hard` copies of it.
void append_completions(const VisibleLayout& layout, std::span<const double> variables, std::vector<double>& smooth,
                        std::vector<double>& hard) {
  std::vector<std::size_t> unknown;
  std::size_t count = 1;
  for (std::size_t v = 0; v < variables.size(); ++v) {
    if (!std::isnan(variables[v])) continue;
    unknown.push_back(v);
    count *= std::size_t(layout.encoders()[v].bin_count());
    if (count > kMaxCompletions)
      throw InputError("training table: a row leaves so many variables unknown that over " +
                       std::to_string(kMaxCompletions) + " combinations of their bins are possible; leave it out");
  }
  std::vector<double> filled(variables.begin(), variables.end()), units(layout.input_unit_count());
  std::vector<Bit> word(layout.input_unit_count());
  for (std::size_t c = 0; c < count; ++c) {
    std::size_t rest = c;
    for (std::size_t v : unknown) {
      const Encoder& encoder = layout.encoders()[v];
      filled[v] = encoder.value(int(rest % std::size_t(encoder.bin_count())));
      rest /= std::size_t(encoder.bin_count());
    }
    layout.encode_smooth(filled, units);
    smooth.insert(smooth.end(), units.begin(), units.end());
    layout.encode(filled, word);
    hard.insert(hard.end(), word.begin(), word.end());
  }
}

torch::Tensor matrix(const std::vector<double>& values, std::int64_t rows, std::int64_t columns) {
  return torch::from_blob(const_cast<double*>(values.data()), {rows, columns}, torch::kFloat64).clone();
}

/// log of the sum over each row's completions: [row x outcome]. Rows without unknown variables pass through.
torch::Tensor sum_completions(const torch::Tensor& scores, const std::vector<std::int64_t>& first) {
  if (scores.size(0) + 1 == std::int64_t(first.size())) return scores;
  std::vector<torch::Tensor> rows;
  for (std::size_t n = 0; n + 1 < first.size(); ++n)
    rows.push_back(torch::logsumexp(scores.slice(0, first[n], first[n + 1]), 0));
  return torch::stack(rows);
}

}  // namespace

std::vector<double> values_of(const torch::Tensor& tensor) {
  const torch::Tensor flat = tensor.detach().cpu().contiguous();
  return std::vector<double>(flat.data_ptr<double>(), flat.data_ptr<double>() + flat.numel());
}

torch::Device torch_device(GradientDevice device) {
  if (device == GradientDevice::cpu) return torch::kCPU;
  if (!torch::cuda::is_available())
    throw InputError("training: gradients are to be worked out on a GPU, and LibTorch sees none here");
  return torch::kCUDA;
}

RowTensors make_rows(const VisibleLayout& layout, const TrainingTable& table, const std::vector<std::size_t>& rows,
                     torch::Device device) {
  RowTensors result;
  std::vector<double> smooth, hard, weight;
  std::vector<std::int64_t> outcome;
  const std::int64_t units = std::int64_t(layout.input_unit_count());
  std::int64_t completions = 0;
  for (std::size_t n : rows) {
    result.first.push_back(completions);
    const std::size_t before = hard.size();
    append_completions(layout, table.row(n), smooth, hard);
    completions += units > 0 ? std::int64_t(hard.size() - before) / units : 1;
    outcome.push_back(std::int64_t(table.outcome[n]));
    weight.push_back(table.weight[n]);
  }
  result.first.push_back(completions);
  result.smooth = matrix(smooth, completions, units).to(device);
  result.hard = matrix(hard, completions, units).to(device);
  result.outcome = torch::tensor(outcome, torch::kInt64).to(device);
  result.weight = torch::tensor(weight, torch::kFloat64).to(device);
  return result;
}

torch::Tensor RowTensors::visible(std::int64_t outcome_count) const {
  if (outcome_count == 0) return hard;
  std::vector<std::int64_t> row;
  for (std::size_t n = 0; n + 1 < first.size(); ++n) row.insert(row.end(), std::size_t(first[n + 1] - first[n]), n);
  const torch::Tensor of_row = torch::tensor(row, torch::kInt64).to(outcome.device());
  const torch::Tensor label = outcome.index_select(0, of_row).unsqueeze(1);
  const torch::Tensor units = torch::zeros({hard.size(0), outcome_count}, hard.options()).scatter(1, label, 1.0);
  return torch::cat({hard, units}, 1);
}

Machine::Machine(const RbmWeights& weights, std::size_t input_unit_count, torch::Device device)
    : weight(
          matrix(weights.weight, std::int64_t(weights.visible_count), std::int64_t(weights.hidden_count)).to(device)),
      centred_visible(torch::tensor(weights.visible_bias, torch::kFloat64).to(device)),
      centred_hidden(torch::tensor(weights.hidden_bias, torch::kFloat64).to(device)),
      visible_mean(torch::zeros({std::int64_t(weights.visible_count)}, weight.options())),
      hidden_mean(torch::zeros({std::int64_t(weights.hidden_count)}, weight.options())),
      input_units(std::int64_t(input_unit_count)) {
  for (torch::Tensor* parameter : {&weight, &centred_visible, &centred_hidden}) parameter->set_requires_grad(true);
}

void Machine::move_means(const torch::Tensor& new_visible_mean, const torch::Tensor& new_hidden_mean) {
  const torch::NoGradGuard constants;
  centred_visible += torch::matmul(weight, new_hidden_mean - hidden_mean);
  centred_hidden += torch::matmul(new_visible_mean - visible_mean, weight);
  visible_mean = new_visible_mean.clone();
  hidden_mean = new_hidden_mean.clone();
}

RbmWeights Machine::weights() const {
  return {.visible_count = std::size_t(weight.size(0)),
          .hidden_count = std::size_t(weight.size(1)),
          .weight = values_of(weight),
          .visible_bias = values_of(visible_bias()),
          .hidden_bias = values_of(hidden_bias())};
}

RbmWeights Machine::gradient() const {
  return {.visible_count = std::size_t(weight.size(0)),
          .hidden_count = std::size_t(weight.size(1)),
          .weight = values_of(weight.grad()),
          .visible_bias = values_of(centred_visible.grad()),
          .hidden_bias = values_of(centred_hidden.grad())};
}

torch::Tensor completed_rows(const Machine& machine, const RowTensors& rows, std::uint64_t seed, std::uint64_t update) {
  const torch::NoGradGuard constants;
  const torch::Tensor visible = rows.visible(machine.weight.size(0) - machine.input_units);
  if (visible.size(0) + 1 == std::int64_t(rows.first.size())) return visible;
  const torch::Tensor score = torch::softplus(torch::matmul(visible, machine.weight) + machine.hidden_bias()).sum(1) +
                              torch::matmul(visible, machine.visible_bias());
  std::vector<std::int64_t> chosen;
  for (std::size_t n = 0; n + 1 < rows.first.size(); ++n) {
    const std::vector<double> p = values_of(torch::softmax(score.slice(0, rows.first[n], rows.first[n + 1]), 0));
    std::size_t k = 0;
    for (double u = random_unit(seed, update, n) - p[0]; u >= 0 && k + 1 < p.size();) u -= p[++k];
    chosen.push_back(rows.first[n] + std::int64_t(k));
  }
  return visible.index_select(0, torch::tensor(chosen, torch::kInt64).to(visible.device()));
}

torch::Tensor negative_free_energy(const Machine& m, const torch::Tensor& inputs) {
  const std::int64_t n = m.input_units, visible = m.weight.size(0);
  const torch::Tensor bias = m.visible_bias();
  const torch::Tensor field = torch::matmul(inputs, m.weight.slice(0, 0, n)) + m.hidden_bias();
  const torch::Tensor of_inputs = torch::matmul(inputs, bias.slice(0, 0, n)).unsqueeze(1);
  if (visible == n) return torch::softplus(field).sum(1, true) + of_inputs;
  const torch::Tensor all = field.unsqueeze(1) + m.weight.slice(0, n, visible).unsqueeze(0);
  return torch::softplus(all).sum(2) + bias.slice(0, n, visible) + of_inputs;
}

torch::Tensor step_units(const VisibleLayout& layout) {
  const std::vector<double> rows = step_rows(layout);
  const auto visible = std::int64_t(layout.unit_count());
  return rows.empty() ? torch::Tensor() : matrix(rows, std::int64_t(rows.size()) / visible, visible);
}

torch::Tensor objective(const Machine& machine, const RowTensors& rows, const torch::Tensor& negative,
                        const TrainingSettings& settings, std::size_t table_rows, double trial_share) {
  const torch::Tensor label = rows.outcome.unsqueeze(1);
  const double count = double(rows.outcome.size(0));
  const torch::Tensor steps = machine.steps.defined() ? torch::matmul(machine.steps, machine.weight) : machine.weight;
  torch::Tensor loss = (steps.square().sum() + machine.hidden_bias().square().sum()) *
                       (settings.weight_decay / (2 * double(table_rows)));
  if (settings.discriminative > 0) {
    const torch::Tensor scores = sum_completions(negative_free_energy(machine, rows.smooth), rows.first);
    const torch::Tensor log_p = scores.gather(1, label).squeeze(1) - torch::logsumexp(scores, 1);
    loss = loss - settings.discriminative * (rows.weight * log_p).sum() / count;
  }
  if (settings.generative > 0) {
    const torch::Tensor scores = sum_completions(negative_free_energy(machine, rows.hard), rows.first);
    const torch::Tensor data = (rows.weight * scores.gather(1, label).squeeze(1)).sum() / count;
    const torch::Tensor field = torch::matmul(negative, machine.weight) + machine.hidden_bias();
    const torch::Tensor model =
        (torch::softplus(field).sum(1) + torch::matmul(negative, machine.visible_bias())).mean();
    loss = loss - settings.generative * (trial_share * data - model);
  }
  return loss;
}

namespace {

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

TeachingTerm::TeachingTerm(const VisibleLayout& layout, const Teaching& teaching, torch::Device device,
                           const TrainingTable* table)
    : weight_(teaching.weight) {
  check_teaching(layout, teaching);
  smooth_ = smooth_units(layout, teaching.points).to(device);
  probability_ = torch::tensor(teaching.probability, torch::kFloat64).to(device);
  passes_ = mask(teaching.label, 1).to(device);
  fails_ = mask(teaching.label, 0).to(device);
  if (teaching.joint_share > 0 && table) take_joint(layout, teaching, points_in_box(teaching, *table));
}

void TeachingTerm::take_joint(const VisibleLayout& layout, const Teaching& teaching,
                              const std::vector<std::size_t>& points) {
  if (points.empty()) return;
  const std::size_t variables = layout.variable_count();
  std::vector<double> words, probability;
  std::vector<Bit> units(layout.input_unit_count());
  for (const std::size_t k : points) {
    layout.encode(std::span(teaching.points).subspan(k * variables, variables), units);
    words.insert(words.end(), units.begin(), units.end());
    probability.push_back(teaching.probability[k]);
  }
  joint_share_ = teaching.joint_share;
  joint_rows_ = matrix(words, std::int64_t(points.size()), std::int64_t(units.size())).to(smooth_.device());
  joint_probability_ = torch::tensor(probability, torch::kFloat64).to(smooth_.device());
}

torch::Tensor TeachingTerm::over(const Machine& machine, const torch::Tensor& smooth,
                                 const torch::Tensor& probability) const {
  const torch::Tensor scores = negative_free_energy(machine, smooth), total = torch::logsumexp(scores, 1);
  const torch::Tensor passes = torch::logsumexp(scores + passes_, 1), fails = torch::logsumexp(scores + fails_, 1);
  return weight_ * (total - probability * passes - (1 - probability) * fails).mean();
}

torch::Tensor TeachingTerm::next(const Machine& machine, std::size_t count) {
  const std::int64_t wanted = std::min(std::int64_t(count), smooth_.size(0));
  const std::int64_t first = first_of_next(next_, wanted, smooth_.size(0));
  return over(machine, smooth_.slice(0, first, next_), probability_.slice(0, first, next_));
}

torch::Tensor TeachingTerm::next_joint(const Machine& machine, double generative, std::size_t count) {
  const std::int64_t wanted = std::min(std::int64_t(count), joint_rows_.size(0));
  const std::int64_t first = first_of_next(next_joint_, wanted, joint_rows_.size(0));
  const torch::Tensor scores = negative_free_energy(machine, joint_rows_.slice(0, first, next_joint_));
  const torch::Tensor passes = torch::logsumexp(scores + passes_, 1), fails = torch::logsumexp(scores + fails_, 1);
  const torch::Tensor probability = joint_probability_.slice(0, first, next_joint_);
  return -joint_share_ * generative * (probability * passes + (1 - probability) * fails).mean();
}

torch::Tensor TeachingTerm::all(const Machine& machine) const { return over(machine, smooth_, probability_); }

}  // namespace gonogo::learning
