// Whether the memory of GPUs suffices for a batch of worlds or for the parts of one, before any of it is taken.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "sim/simulation/layout/part.h"

namespace gonogo::sim {

/// Bytes of GPU memory that a batch takes before its first step, with room for four contacts per shape; more contacts
/// take more later. Without meshes, heightfields and scratch memory. `turning`: see needs_turning() in batch_arrays.h.
double device_bytes(const std::vector<WorldSize>& places, const StepSettings& settings, bool turning);

/// Free bytes of this thread's GPU. None for the host, whose memory is not watched.
std::optional<double> free_memory(bool on_gpu);

/// While it lives, GPU and host have so many free bytes; for tests.
class PlantedMemory {
 public:
  explicit PlantedMemory(double bytes);
  ~PlantedMemory();
  PlantedMemory(const PlantedMemory&) = delete;
  PlantedMemory& operator=(const PlantedMemory&) = delete;
};

/// Bytes of the largest of `count` parts.
double bytes_of_parts(const FlatWorld& world, const Snapshot& at, const StepSettings& settings, int count);

/// Fewest GPUs with so much free memory that would do, with a twentieth to spare; 0: not even kMaxGpus.
int gpus_that_do(const FlatWorld& world, const Snapshot& at, const StepSettings& settings, double free);

/// Throws OutOfMemory, with the number of GPUs that would do, when a batch does not fit into the GPU's free memory.
void require_memory(bool on_gpu, const std::vector<FlatWorld>& worlds, const WorldSize& room,
                    const StepSettings& settings);

/// "out of GPU memory: <what> needs 1.5 GiB and 1.2 GiB are free; <remedy>". `gpus`: that would do.
std::string memory_sentence(const std::string& what, double needed, double free, int gpus);

}  // namespace gonogo::sim
