#include "learning/sampler/chains/gpu_chains.h"

#include <cmath>
#include <limits>
#include <string>

#include "base/format.h"
#include "base/parallel/buffer.h"
#include "base/parallel/device.h"
#include "base/parallel/for_each.h"
#include "learning/sampler/chains/gibbs_kernel.cuh"

namespace gonogo::learning {
namespace {

using Kernel = void (*)(GibbsMachine, std::uint64_t, std::uint64_t);

template <int kChains, int... kSideTiles>
Kernel kernel_for(int side_tiles, std::integer_sequence<int, kSideTiles...>) {
  constexpr Kernel kernels[] = {gibbs_kernel<kChains, kSideTiles>...};
  return kernels[side_tiles];
}

/// Sides of nearly the same size are given the same number of tiles, which the compiler then knows.
int common_tiles(int left, int right) {
  const int more = std::max(left, right), less = std::min(left, right);
  return more <= kMaxWarps && 4 * less >= 3 * more ? more : 0;
}

/// Tiles of 16 chains in a block: many where the batch fills the GPU all the same.
constexpr int kManyChains = 4, kFewChains = 1;

void require_gpu() {
  int count = 0;
  const cudaError_t status = cudaGetDeviceCount(&count);
  if (status != cudaSuccess || count == 0)
    throw InputError(std::string("sampler block_gibbs: no GPU answers on this machine (") +
                     (status != cudaSuccess ? cudaGetErrorString(status) : "there is none") + "); sample on the cpu");
}

GibbsSide side_of(std::size_t units, int shift) {
  const int width = int(units) + shift;
  return {int(units), shift, std::max(1, (width + kTile - 1) / kTile), nullptr};
}

/// In the order of the units; a place without a unit is never on.
std::vector<float> fields(const GibbsSide& side, const std::vector<double>& bias) {
  std::vector<float> field(std::size_t(side.width()), 1e30f);
  for (std::size_t i = 0; i < bias.size(); ++i) field[i + std::size_t(side.shift)] = float(-bias[i] / std::log(2.0));
  return field;
}

__half half_of(double weight) {
  constexpr double kMax = 65504;
  if (!(std::abs(weight) <= kMax))
    throw InputError("sampler block_gibbs: a weight is " + number_text(weight, 8) +
                     "; weights of 16 bits end at 65504; sample on the cpu");
  return __double2half(weight);
}

std::vector<__half> weights(const Bipartite& machine, const GibbsSide& left, const GibbsSide& right) {
  std::vector<__half> weight(std::size_t(left.width()) * right.stride(), __double2half(0));
  for (int i = 0; i < left.units; ++i)
    for (int j = 0; j < right.units; ++j)
      weight[std::size_t(column_of_unit(i, left.shift)) * right.stride() + column_of_unit(j, right.shift)] =
          half_of(machine.weight[std::size_t(i) * right.units + j]);
  return weight;
}

}  // namespace

bool gpu_answers() {
  int count = 0;
  return cudaGetDeviceCount(&count) == cudaSuccess && count > 0;
}

struct GpuChains::Device {
  explicit Device(std::uint64_t seed)
      : machine{.left = {},
                .right = {},
                .weight = nullptr,
                .keys = PhiloxKeys(seed),
                .chains = 0,
                .row = nullptr,
                .begun = nullptr} {}

  GibbsMachine machine;
  Buffer<__half, Cuda> weight;
  Buffer<float, Cuda> left_field, right_field;
  Buffer<Bit, Cuda> row;
  Buffer<unsigned, Cuda> begun;
  int chains_per_block = kFewChains;
  int side_tiles = 0;  // see common_tiles

  void choose_block() {
    const int offered = device_attribute(cudaDevAttrMaxSharedMemoryPerBlockOptin);
    const int blocks = machine.chains / (kManyChains * kTile);
    if (blocks >= device_attribute(cudaDevAttrMultiProcessorCount) && room(kManyChains) <= std::size_t(offered))
      chains_per_block = kManyChains;
    if (room(chains_per_block) > std::size_t(offered))
      throw InputError("sampler block_gibbs: a machine of " + std::to_string(machine.left.units) + " and " +
                       std::to_string(machine.right.units) + " units needs " + std::to_string(room(chains_per_block)) +
                       " bytes of one multiprocessor, which offers " + std::to_string(offered) + "; sample on the cpu");
  }

  std::size_t room(int tiles) const { return GibbsRoom(machine.left, machine.right, tiles * kTile).bytes; }

  template <int kChains>
  void launch(std::uint64_t first, std::uint64_t count) {
    const Kernel kernel = kernel_for<kChains>(side_tiles, std::make_integer_sequence<int, kMaxWarps + 1>());
    const int tiles = std::max(machine.left.tiles, machine.right.tiles);
    const int rounds = (tiles + kMaxWarps - 1) / kMaxWarps, warps = (tiles + rounds - 1) / rounds;
    const int groups = (machine.chains + kChains * kTile - 1) / (kChains * kTile);
    check_cuda(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize, int(room(kChains))),
               "shared memory of the sampler");
    // All of it: the blocks that the next call counts have to be there at the same time.
    check_cuda(
        cudaFuncSetAttribute(kernel, cudaFuncAttributePreferredSharedMemoryCarveout, cudaSharedmemCarveoutMaxShared),
        "shared memory of the sampler");
    int at_once = 0;  // blocks of a multiprocessor
    check_cuda(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&at_once, kernel, 32 * warps, room(kChains)),
               "blocks of the sampler");
    const int blocks = std::min(groups, at_once * device_attribute(cudaDevAttrMultiProcessorCount));
    begun.fill_zero(std::size_t(blocks));
    machine.begun = begun.data();
    void* arguments[] = {&machine, &first, &count};
    check_cuda(cudaLaunchCooperativeKernel(reinterpret_cast<const void*>(kernel), dim3(unsigned(blocks)),
                                           dim3(unsigned(32 * warps)), arguments, room(kChains), nullptr),
               "sampler launch");
    check_cuda(cudaDeviceSynchronize(), "sampler");
  }
};

GpuChains::GpuChains(const Bipartite& machine, std::size_t chains, std::uint64_t seed) {
  require_gpu();
  if (chains > std::size_t(std::numeric_limits<Index>::max()) /
                   std::max<std::size_t>(1, machine.left.size() + machine.right.size()))
    throw InputError("sampler block_gibbs: " + std::to_string(chains) + " chains of " +
                     std::to_string(machine.left.size() + machine.right.size()) + " units are too many at once");
  device_ = std::make_unique<Device>(seed);
  GibbsMachine& m = device_->machine;
  m.left = side_of(machine.left.size(), int(machine.right.size() % 4));
  m.right = side_of(machine.right.size(), 0);
  m.chains = int(chains);
  device_->side_tiles = common_tiles(m.left.tiles, m.right.tiles);
  if (device_->side_tiles > 0) m.left.tiles = m.right.tiles = device_->side_tiles;
  device_->choose_block();
  device_->weight.upload(weights(machine, m.left, m.right));
  device_->left_field.upload(fields(m.left, machine.bias_left));
  device_->right_field.upload(fields(m.right, machine.bias_right));
  device_->row.fill_zero(chains * (machine.left.size() + machine.right.size()));
  m.weight = device_->weight.data();
  m.left.field = device_->left_field.data();
  m.right.field = device_->right_field.data();
  m.row = device_->row.data();
}

GpuChains::~GpuChains() = default;

void GpuChains::scatter() {
  for_each_index(Cuda{}, device_->machine.chains, ScatterChain{device_->machine});
  check_cuda(cudaDeviceSynchronize(), "scatter");
}

void GpuChains::set_rows(const std::vector<Bit>& rows) { device_->row.write(0, rows); }

std::vector<GpuChains::Bit> GpuChains::rows() const { return device_->row.download(); }

void GpuChains::sweep(std::uint64_t first, std::uint64_t count) {
  if (count == 0) return;
  if (device_->chains_per_block == kManyChains)
    device_->launch<kManyChains>(first, count);
  else
    device_->launch<kFewChains>(first, count);
}

}  // namespace gonogo::learning
