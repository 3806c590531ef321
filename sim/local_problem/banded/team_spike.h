// SPIKE (spike.h) with a team of threads for each partition, written once for the CPU and the GPU.
//
// Many short partitions run side by side, hundreds to thousands of them. Their reduced system is solved by pairs: two
// neighbours become one partition with tips of its own, and so on up a tree (recursive SPIKE, Polizzi & Sameh 2006).
// Truncated SPIKE has a pair for each joint and no tree.
//
// On the GPU the matrix and its factors stay there. The CPU runs the same code with the same bits where its processor
// fuses multiply and add, for tests; spike.h is faster there.
#pragma once
#include <memory>
#include <vector>

namespace gonogo::sim {

template <class Scalar>
struct BandedMatrix;

/// spike.h explains the two.
enum class SpikeKind { full, truncated };

struct TeamSpikeSettings {
  int partitions = 0;  // at most, 2 half rows or more each; 0: chosen by size and half
  SpikeKind kind = SpikeKind::full;
  bool is_single = false;  // factors in float
};

/// One matrix, any number of right-hand sides. Calls may return before the GPU is done; reading waits for it.
class TeamSpike {
 public:
  struct Refined {
    double residual = 0;  // |b - A x| / |b|
    int iterations = 0;   // solutions taken
  };

  virtual ~TeamSpike() = default;
  virtual void factorise() = 0;
  virtual void set_right_side(const std::vector<double>& b) = 0;
  /// One solution, approximate when truncated or in float.
  virtual void solve() = 0;
  /// Solutions until |b - A x| <= tolerance |b|, `max` of them or one that does not halve it. The best one is kept.
  virtual Refined refine(double tolerance, int max = 50) = 0;
  virtual void wait() = 0;
  virtual std::vector<double> solution() = 0;

  virtual int partitions() const = 0;
  virtual int boosted() = 0;              // pivots that were lifted, of partitions and joints
  virtual std::size_t bytes() const = 0;  // of factors and tips
};

std::unique_ptr<TeamSpike> team_spike_on_cpu(const BandedMatrix<double>& a, const TeamSpikeSettings& settings,
                                             int threads = 1);

/// InputError where the program has no CUDA, no GPU answers, or a partition's rows exceed what it can hold at once
/// (half above 93 on Hopper, 77 on Ampere); DeviceError when the GPU's memory is full.
std::unique_ptr<TeamSpike> team_spike_on_gpu(const BandedMatrix<double>& a, const TeamSpikeSettings& settings);

}  // namespace gonogo::sim
