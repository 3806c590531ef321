// A teacher's soft labels, which machines are trained on beside their trials. The objective that they enter is in
// learning/rbm/train.h.
#pragma once
#include <cstddef>
#include <vector>

#include "learning/encoding/layout.h"
#include "learning/training.h"

namespace gonogo::learning {

/// Soft labels that a machine is trained on beside its trials. A teacher, which does better with few trials, says P(1 |
/// x) at points without a trial (Hinton, Vinyals, Dean, "Distilling the knowledge in a neural network", 2015). The
/// objective gains, with class c of {0, 1} of every outcome,
///
///   - t mean_k sum_c q_k(c) log P(c | x_k),   P(c | x) = sum of P(y | x) over the outcomes y of class c
///
/// so that only the class is taught. Which outcome of a class it is stays with the trials.
///
/// A few trials say little of the joint distribution. So with a joint share r the rows of the second term's data are
/// 1 - r of the trials and r of the points inside the box of the trials, there the mean of sum_c q_k(c) log P(x_k, c).
struct Teaching {
  double weight = 0;                // t; 0: no teaching
  std::vector<double> points;       // [point x variable count], all known
  std::vector<double> probability;  // [point]: P(1 | x) by the teacher, in [0, 1]
  std::vector<int> label;           // [outcome]: its class, 0 or 1
  /// r in [0, 1]; above 0 only where points are drawn from the distribution of the trials
  double joint_share = 0;
  std::size_t joint_every = 1;  // points 0, joint_every, 2 joint_every ... are, and they alone share
};

/// Throws InputError if the points do not match the layout, a probability lies outside [0, 1], or a class has no
/// outcome.
void check_teaching(const VisibleLayout& layout, const Teaching& teaching);

/// The first of the next `count` of `size` points, which follow each other around; `next` moves on.
template <class Count>
Count first_of_next(Count& next, Count count, Count size) {
  if (next + count > size) next = 0;
  const Count first = next;
  next += count;
  return first;
}

inline constexpr std::size_t kJointPoints = 64;  // of an update, at least

/// The points of a teaching that lie between the least and the largest known value of every variable of the table, as
/// indices.
std::vector<std::size_t> points_in_box(const Teaching& teaching, const TrainingTable& table);

}  // namespace gonogo::learning
