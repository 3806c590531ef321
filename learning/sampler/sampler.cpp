#include "learning/sampler/sampler.h"

#include "base/error.h"
#include "learning/sampler/annealing.h"
#include "learning/sampler/block_gibbs.h"
#include "learning/sampler/exact.h"
#include "learning/sampler/external.h"

namespace gonogo::learning {

std::unique_ptr<Sampler> make_sampler(const std::string& name, const SamplerSettings& settings) {
  if (name == "block_gibbs") return std::make_unique<BlockGibbs>(settings.on_gpu);
  if (name == "anneal") return std::make_unique<Annealer>(settings);
  if (name == "tempering") return std::make_unique<Tempering>(settings);
  if (name == "population") return std::make_unique<PopulationAnnealing>(settings);
  if (name == "exact") return std::make_unique<ExactSampler>();
  if (name == "file") return std::make_unique<FileSampler>(settings);
  if (name == "command") return std::make_unique<CommandSampler>(settings);
  throw InputError("sampler \"" + name +
                   "\" does not exist; use block_gibbs, anneal, tempering, population, exact, file or command");
}

}  // namespace gonogo::learning
