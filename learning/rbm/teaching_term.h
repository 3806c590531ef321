// The teacher's term of the objective (teaching.h). Only inside learning/rbm.
#pragma once
#include "learning/rbm/teaching.h"
#include "learning/rbm/tensors.h"

namespace gonogo::learning {

class TeachingTerm {
 public:
  /// Throws InputError if the points do not match the layout, a probability lies outside [0, 1], or a class has no
  /// outcome.
  TeachingTerm(const VisibleLayout& layout, const Teaching& teaching, torch::Device device = torch::kCPU);
  /// The term over the next `count` points, which follow each other around.
  torch::Tensor next(const Machine& machine, std::size_t count);
  /// The term over all points.
  torch::Tensor all(const Machine& machine) const;

 private:
  torch::Tensor over(const Machine& machine, const torch::Tensor& smooth, const torch::Tensor& probability) const;
  double weight_;
  torch::Tensor smooth_, probability_;  // [point x input unit], [point]
  torch::Tensor passes_, fails_;        // [outcome]: 0 for the outcomes of the class, minus infinity for all others
  std::int64_t next_ = 0;
};

}  // namespace gonogo::learning
