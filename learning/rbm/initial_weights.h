// Weights that a training run starts from. Only inside learning/rbm.
#pragma once
#include "learning/encoding/layout.h"
#include "learning/model/weights.h"
#include "learning/table.h"
#include "learning/training_settings.h"

namespace gonogo::learning {

/// Small random weights. Visible biases give every variable and the outcome nearly the marginal that the rows have,
/// half a row added to each unit, word or outcome, so that what never happened starts rare but possible. A machine of
/// code words has the marginals of the words; any other, those of single units.
RbmWeights initial_weights(const VisibleLayout& layout, const TrainingTable& table, const TrainingSettings& settings);

}  // namespace gonogo::learning
