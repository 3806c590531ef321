#include "pipeline/campaign/dataset/gravity.h"

#include "base/json/config.h"
#include "pipeline/campaign/study/study.h"

namespace gonogo::campaign {

double gravity_of(const Provenance& provenance, const std::string& where) {
  if (provenance.study.empty()) return kGravity;
  return Config::parse(provenance.study, where + ": study").number_or("gravity", kGravity, kGravityRange);
}

}  // namespace gonogo::campaign
