// The gravity of the trials that a model learned from.
#pragma once
#include "base/units.h"
#include "learning/model/model.h"
#include "pipeline/campaign/study/study.h"

namespace gonogo::learn {

/// [m/s^2]; files without the key are of the Earth.
inline double gravity_of(const learning::Model& model) {
  const Json* gravity = model.provenance.find(campaign::kGravityKey);
  return gravity ? gravity->number() : kGravity;
}

}  // namespace gonogo::learn
