#include "learning/sampler/sampler.h"

#include "base/error.h"
#include "learning/sampler/block_gibbs.h"
#include "learning/sampler/exact.h"

namespace gonogo::learning {

std::unique_ptr<Sampler> make_sampler(const std::string& name) {
  if (name == "block_gibbs") return std::make_unique<BlockGibbs>();
  if (name == "exact") return std::make_unique<ExactSampler>();
  throw InputError("sampler \"" + name + "\" does not exist; use block_gibbs or exact");
}

}  // namespace gonogo::learning
