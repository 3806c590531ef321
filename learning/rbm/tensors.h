// Inside learning/rbm only: a table as tensors, the machine as parameters, and the terms of the objective.
#pragma once
#include <torch/torch.h>

#include <ATen/Parallel.h>

#include "learning/rbm/train.h"

namespace gonogo::learning {

/// LibTorch on one thread while this lives: its reductions depend on the number of threads, our results must not.
class OneTorchThread {
 public:
  OneTorchThread() : before_(at::get_num_threads()) { at::set_num_threads(1); }
  ~OneTorchThread() { at::set_num_threads(before_); }
  OneTorchThread(const OneTorchThread&) = delete;
  OneTorchThread& operator=(const OneTorchThread&) = delete;

 private:
  int before_;
};

/// Rows with their unknown variables filled by every combination of code words: the completions of row n are
/// first[n] .. first[n + 1] - 1, one when all is known.
struct RowTensors {
  torch::Tensor smooth, hard;       // [completion x input unit]
  torch::Tensor outcome, weight;    // [row]
  std::vector<std::int64_t> first;  // [row + 1]
};
RowTensors make_rows(const VisibleLayout& layout, const TrainingTable& table, const std::vector<std::size_t>& rows);

struct Machine {
  torch::Tensor weight;        // W [visible x hidden]
  torch::Tensor visible_bias;  // [visible]
  torch::Tensor hidden_bias;   // [hidden]
  std::int64_t input_units = 0;

  Machine(const RbmWeights& weights, std::size_t input_unit_count);
  RbmWeights weights() const;
  RbmWeights gradient() const;
  std::vector<torch::Tensor> parameters() const { return {weight, visible_bias, hidden_bias}; }
};

/// L of train.h; negative: [row x visible], or undefined without a generative term. table_rows is N.
torch::Tensor objective(const Machine& machine, const RowTensors& rows, const torch::Tensor& negative,
                        const TrainingSettings& settings, std::size_t table_rows);

}  // namespace gonogo::learning
