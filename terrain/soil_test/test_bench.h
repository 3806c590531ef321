// Soil tests side by side. On the CPU each test steps a world of its own. On a GPU, tests of equal settings are worlds
// of one batch: each waits for the steps it has asked for, and the last one to wait takes them for all.
#pragma once
#include <functional>
#include <memory>
#include <vector>

#include "sim/simulation/simulation.h"

namespace gonogo::terrain {

/// What the steps of one test's world gave.
struct StepsTaken {
  std::vector<Vec3d> mean_force;  // contact force on each measured body, mean over the steps [N]
  double worst_residual = 0;      // largest root-mean-square residual [m/s]
  sim::StepReport last;           // with flags: the simulation failed, and the steps after the failure are missing
};

/// The place of one test's world in a simulation. Its destructor gives the place up.
class TestSeat {
 public:
  virtual ~TestSeat() = default;

  /// Residuals and forces are taken after every step if bodies are measured, otherwise after the last one.
  virtual StepsTaken take(Index steps, const std::vector<sim::BodyIndex>& measured) = 0;
  /// Calls f while no other test uses the simulation.
  virtual void with(const std::function<void(sim::Simulation&, sim::WorldIndex)>& f) = 0;
};

class TestBench {
 public:
  /// `threads`: number of tests at a time that step alone, or of the batch's simulation on the CPU. Tests that step
  /// `together` do so on the first GPU, up to 1,024 of them at once. A test has the same bits either way.
  TestBench(sim::Backend backend, int threads) : TestBench(backend, threads, backend != sim::Backend::cpu) {}
  TestBench(sim::Backend backend, int threads, bool together);
  ~TestBench();

  /// Runs job(0) .. job(count - 1). The first failure or Ctrl-C stops the others and is thrown.
  void run(std::size_t count, const std::function<void(std::size_t)>& job);

  sim::Backend backend() const { return backend_; }

  /// Called by a job of run(): a place on the bench's device. `threads`: of a simulation on the CPU.
  std::unique_ptr<TestSeat> seat(const sim::SceneWorld& world, const sim::StepSettings& settings, int threads);

 private:
  class Hall;

  sim::Backend backend_;
  int threads_;
  std::unique_ptr<Hall> hall_;  // of tests that step together
};

/// A simulation on the CPU for one test.
std::unique_ptr<TestSeat> own_seat(const sim::SceneWorld& world, const sim::StepSettings& settings, int threads);

}  // namespace gonogo::terrain
