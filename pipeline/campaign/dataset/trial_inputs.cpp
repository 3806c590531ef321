#include "pipeline/campaign/dataset/trial_inputs.h"

#include <optional>

#include "base/json/json.h"

namespace gonogo::campaign {
namespace {

/// Value of a key of the study's section "trial"; nothing where it has none.
std::optional<Json> of_trial(const Provenance& provenance, const std::string& where, const char* key) {
  const Json study = Json::parse(provenance.study, where + ": study");
  const Json* trial = study.find("trial");
  const Json* value = trial ? trial->find(key) : nullptr;
  return value ? std::optional(*value) : std::nullopt;
}

}  // namespace

const std::string* input_text(const Provenance& provenance, const char* name) {
  for (const auto& [key, text] : provenance.files)
    if (key == name) return &text;
  return nullptr;
}

bool had_compliant_tyres(const Provenance& provenance, const std::string& where) {
  const auto compliant = of_trial(provenance, where, "compliant_tyres");
  return compliant && compliant->boolean();
}

double wheel_rolling_of(const Provenance& provenance, const std::string& where) {
  const auto rolling = of_trial(provenance, where, "wheel_rolling");
  return rolling ? rolling->number() : 0;
}

}  // namespace gonogo::campaign
