// What the provenance of a dataset says of its trials' vehicle and soil.
#pragma once
#include <string>

#include "pipeline/campaign/dataset/dataset.h"

namespace gonogo::campaign {

/// Text of a file that the trials depend on ("vehicle", "calibration", ...); null where the dataset does not hold it.
const std::string* input_text(const Provenance& provenance, const char* name);

/// Whether tyres were compliant in the trials. `where` starts the messages. Throws InputError for a study that is no
/// JSON.
bool had_compliant_tyres(const Provenance& provenance, const std::string& where);

/// Rolling friction of grains on the wheels of the trials, over that between grains [-]. Throws as the above.
double wheel_rolling_of(const Provenance& provenance, const std::string& where);

}  // namespace gonogo::campaign
