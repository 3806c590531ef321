#include "pipeline/campaign/dataset/trial_inputs.h"

#include "base/json/config.h"
#include "pipeline/campaign/study/study.h"

namespace gonogo::campaign {

const std::string* input_text(const Provenance& provenance, const char* name) {
  for (const auto& [key, text] : provenance.files)
    if (key == name) return &text;
  return nullptr;
}

TrialSettings settings_of(const Provenance& provenance, const std::string& where) {
  TrialSettings s;
  if (provenance.study.empty()) return s;
  const Config study = Config::parse(provenance.study, where + ": study");
  s.gravity = study.number_or("gravity", s.gravity, kGravityRange);
  if (const auto trial = study.object_if("trial")) {
    s.compliant_tyres = trial->boolean_or("compliant_tyres", s.compliant_tyres);
    s.wheel_rolling = trial->number_or("wheel_rolling", s.wheel_rolling, kWheelRollingRange);
  }
  return s;
}

}  // namespace gonogo::campaign
