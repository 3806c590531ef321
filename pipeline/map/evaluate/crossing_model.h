// Ditches on a map, answered by a model of trials that cross them.
//
// A point of the contract with a ditch in it, ditch_width and ditch_depth above 0, is put to both models. The least of
// the two P(go) counts. Both are about one event chain on one ground: who crosses the ditch has driven the ground
// around it, so that P(both) = P(ditch) where the models are right, and P(both) <= min in any case (Frechet). A product
// would take the two for independent, and count weak soil twice.
#pragma once
#include "pipeline/map/evaluate/outcome_model.h"

namespace gonogo::map {

/// Lets `model` answer for points with a ditch. Every outcome probability of such a point is that of the model with
/// the lower P(go). Where that is the crossing model, all that does not go is no_go/obstacle: the soil alone lets it
/// pass. `crossing_sampled` becomes the box of both models, and that of `crossing` in the sizes of ditches. Its trials
/// lie in deeper soft soil than a trench needs; shallower soil is no weaker, so that a smaller bed_depth counts as
/// theirs. Members of `crossing` are left out.
void add_crossing_model(OutcomeModel& model, const OutcomeModel& crossing);

}  // namespace gonogo::map
