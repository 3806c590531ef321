// A table as tensors, the machine as parameters, and the terms of the objective. Only inside learning/rbm.
#pragma once
#include <ATen/Parallel.h>
#include <omp.h>
#include <torch/torch.h>

#include "learning/rbm/train.h"

namespace gonogo::learning {

/// Keeps LibTorch on one thread while it lives, because its reductions depend on the number of threads. Restores the
/// number of OpenMP, which at::get_num_threads() would set to that of physical cores when it is first called.
class OneTorchThread {
 public:
  OneTorchThread() : before_(omp_get_max_threads()) { at::set_num_threads(1); }
  ~OneTorchThread() { at::set_num_threads(before_); }
  OneTorchThread(const OneTorchThread&) = delete;
  OneTorchThread& operator=(const OneTorchThread&) = delete;

 private:
  int before_;
};

/// The numbers of a tensor of doubles, row by row.
std::vector<double> values_of(const torch::Tensor& tensor);

/// Throws InputError for `cuda` when this LibTorch has no GPU.
torch::Device torch_device(GradientDevice device);

/// Completed rows: unknown variables take every combination of code words. The completions of row n are first[n] ..
/// first[n + 1] - 1; a known row has one.
struct RowTensors {
  /// Rows of `hard` with the outcome's units, [completion x visible].
  torch::Tensor visible(std::int64_t outcome_count) const;
  torch::Tensor smooth, hard;       // [completion x input unit]
  torch::Tensor outcome, weight;    // [row]
  std::vector<std::int64_t> first;  // [row + 1]
};
RowTensors make_rows(const VisibleLayout& layout, const TrainingTable& table, const std::vector<std::size_t>& rows,
                     torch::Device device = torch::kCPU);

/// The machine in centred units: E = -A.(v - mu) - B.(h - lambda) - (v - mu)' W (h - lambda), which is the machine with
/// biases a = A - W lambda and b = B - W' mu. With mu = lambda = 0 these are the usual parameters.
struct Machine {
  torch::Tensor weight;           // W [visible x hidden]
  torch::Tensor centred_visible;  // A [visible]
  torch::Tensor centred_hidden;   // B [hidden]
  torch::Tensor visible_mean;     // mu, a constant
  torch::Tensor hidden_mean;      // lambda, a constant
  torch::Tensor steps;            // D of step_units(), a constant; undefined: the identity
  std::int64_t input_units = 0;

  torch::Tensor visible_bias() const { return centred_visible - torch::matmul(weight, hidden_mean); }
  torch::Tensor hidden_bias() const { return centred_hidden - torch::matmul(visible_mean, weight); }
  /// Changes the constants, not the machine.
  void move_means(const torch::Tensor& new_visible_mean, const torch::Tensor& new_hidden_mean);

  Machine(const RbmWeights& weights, std::size_t input_unit_count, torch::Device device = torch::kCPU);
  torch::Device device() const { return weight.device(); }
  RbmWeights weights() const;
  RbmWeights gradient() const;
  std::vector<torch::Tensor> parameters() const { return {weight, centred_visible, centred_hidden}; }
};

/// D of step_rows(); undefined if it is the identity.
torch::Tensor step_units(const VisibleLayout& layout);

/// One completion of each row, drawn by the machine's probabilities: [row x visible].
torch::Tensor completed_rows(const Machine& machine, const RowTensors& rows, std::uint64_t seed, std::uint64_t update);

/// -F(v, y) for every row of code units and every outcome: [row x outcome]; one column in a machine without outcomes.
torch::Tensor negative_free_energy(const Machine& machine, const torch::Tensor& inputs);

/// L of train.h; negative: [row x visible], or undefined without a generative term. table_rows is N. trial_share: of
/// the second term's data, 1 - r.
torch::Tensor objective(const Machine& machine, const RowTensors& rows, const torch::Tensor& negative,
                        const TrainingSettings& settings, std::size_t table_rows, double trial_share = 1);

/// The teacher's term of the objective.
class TeachingTerm {
 public:
  /// Throws as check_teaching() does.
  /// `table`: the trials, whose box holds the points of the joint share; none is needed without one.
  TeachingTerm(const VisibleLayout& layout, const Teaching& teaching, torch::Device device = torch::kCPU,
               const TrainingTable* table = nullptr);
  /// The term over the next `count` points, which follow each other around.
  torch::Tensor next(const Machine& machine, std::size_t count);
  /// The term over all points.
  torch::Tensor all(const Machine& machine) const;
  /// The share of these points in the data of the second term: - r g mean sum_c q_k(c) (-F(x_k, c)), over the next
  /// `count` points inside the box. Called when the share is above 0.
  torch::Tensor next_joint(const Machine& machine, double generative, std::size_t count);
  double joint_share() const { return joint_share_; }

 private:
  torch::Tensor over(const Machine& machine, const torch::Tensor& smooth, const torch::Tensor& probability) const;
  void take_joint(const VisibleLayout& layout, const Teaching& teaching, const std::vector<std::size_t>& points);
  double weight_, joint_share_ = 0;
  torch::Tensor smooth_, probability_;            // [point x input unit], [point]
  torch::Tensor joint_rows_, joint_probability_;  // the same of code words inside the box
  torch::Tensor passes_, fails_;  // [outcome]: 0 for the outcomes of the class, minus infinity for all others
  std::int64_t next_ = 0, next_joint_ = 0;
};

}  // namespace gonogo::learning
