// In builds without CUDA.
#include "base/error.h"
#include "learning/sampler/chains/gpu_chains.h"

namespace gonogo::learning {

bool gpu_answers() { return false; }

struct GpuChains::Device {};

GpuChains::GpuChains(const Bipartite&, std::size_t, std::uint64_t) {
  throw InputError(
      "sampler block_gibbs: this program was built without CUDA; build the cuda-release preset or sample on the cpu");
}
GpuChains::~GpuChains() = default;
void GpuChains::scatter() {}
void GpuChains::set_rows(const std::vector<Bit>&) {}
std::vector<GpuChains::Bit> GpuChains::rows() const { return {}; }
void GpuChains::sweep(std::uint64_t, std::uint64_t) {}

}  // namespace gonogo::learning
