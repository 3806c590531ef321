#include "pipeline/campaign/dataset/trial_inputs.h"

#include "base/json/json.h"

namespace gonogo::campaign {

const std::string* input_text(const Provenance& provenance, const char* name) {
  for (const auto& [key, text] : provenance.files)
    if (key == name) return &text;
  return nullptr;
}

bool had_compliant_tyres(const Provenance& provenance, const std::string& where) {
  const Json study = Json::parse(provenance.study, where + ": study");
  const Json* trial = study.find("trial");
  const Json* compliant = trial ? trial->find("compliant_tyres") : nullptr;
  return compliant && compliant->boolean();
}

}  // namespace gonogo::campaign
