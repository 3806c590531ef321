// What the provenance of a dataset says of its trials: vehicle, soil, gravity, tyres.
#pragma once
#include <string>

#include "base/units.h"
#include "pipeline/campaign/dataset/dataset.h"

namespace gonogo::campaign {

/// Text of a file that the trials depend on ("vehicle", "calibration", ...); null where the dataset does not hold it.
const std::string* input_text(const Provenance& provenance, const char* name);

/// What the study of a dataset sets for all of its trials. A study without a key has the value here, and so has a
/// dataset without a study.
struct TrialSettings {
  double gravity = kGravity;     // [m/s^2]
  bool compliant_tyres = false;  // see TrialSetup
  double wheel_rolling = 0;      // rolling friction of grains on wheels over that between grains [-]
};

/// `where` starts the messages. Throws InputError for a study that is no JSON and for a value out of range.
TrialSettings settings_of(const Provenance& provenance, const std::string& where);

}  // namespace gonogo::campaign
