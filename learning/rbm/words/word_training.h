// Training of machines of code words whose rows are all known, without LibTorch: the objective of learning/rbm/train.h
// with its gradient in closed form (word_gradient.h). One thread; several machines may be trained at a time.
#pragma once
#include <cstdint>

#include "learning/machine/word_machine.h"
#include "learning/rbm/words/teaching.h"
#include "learning/rbm/words/training_run.h"

namespace gonogo::learning {

/// The chains of code words of a training run.
WordChains word_chains(const TrainingSettings& settings);

/// Whether the machine is one of code words and no row leaves a variable unknown.
bool are_words(const VisibleLayout& layout, const TrainingTable& table, const TrainingSettings& settings);

/// Trains on all rows, from `start`. The bits depend on the seed alone. Throws InputError for a table that is empty or
/// does not match the layout, and for a teacher that does not fit.
TrainingResult train_words(const VisibleLayout& layout, const TrainingTable& table, const TrainingSettings& settings,
                           const EpochHook& hook, const RbmWeights& start, const Teaching* teaching = nullptr);

/// The same machine with other biases of the inputs, by which the words of every variable are as frequent among its own
/// rows as in the table, or in the box of the trials as far as `teaching` shares in the joint distribution. These
/// biases have no part in P(y | x), and training leaves them behind the weights. Robbins-Monro steps on rows of
/// tempered chains; deterministic.
RbmWeights balanced_inputs(const VisibleLayout& layout, const TrainingTable& table, RbmWeights weights,
                           std::uint64_t seed, const Teaching* teaching = nullptr);

}  // namespace gonogo::learning
