// The gravity that the trials of a dataset had.
#pragma once
#include <string>

#include "pipeline/campaign/dataset/dataset.h"

namespace gonogo::campaign {

/// [m/s^2]; the Earth's where the study in the provenance names none. `where` starts the messages. Throws InputError
/// for a study that is no JSON and for a gravity out of range.
double gravity_of(const Provenance& provenance, const std::string& where);

}  // namespace gonogo::campaign
