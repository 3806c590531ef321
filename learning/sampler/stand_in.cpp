#include "learning/sampler/stand_in.h"

#include <cstdio>

#include "base/error.h"

namespace gonogo::learning {

SampleSet WithStandIn::sample(const Problem& problem, const SampleRequest& request) const {
  if (!stood_in()) {
    try {
      return wanted_->sample(problem, request);
    } catch (const InputError& error) {
      reason_ = error.what();
    } catch (const DeviceError& error) {
      reason_ = error.what();
    }
    std::fprintf(stderr, "sampler %s cannot be used, %s stands in: %s\n", wanted_->name().c_str(),
                 other_->name().c_str(), reason_.c_str());
  }
  return other_->sample(problem, request);
}

}  // namespace gonogo::learning
