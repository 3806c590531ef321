// A world divided over the processes of an MPI job, under a real mpirun.
#include <chrono>

#include "base/files/file.h"
#include "sim/io/checkpoint.h"
#include "sim/io/part_files.h"
#include "tests/fault/shell.h"
#include "tests/sim/divided_scenes.h"
#include "tests/support/catch.h"
#include "tests/support/md5.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"

using namespace gonogo;
using namespace gonogo::test;

namespace {

constexpr Index kSteps = 200, kHalf = 100;

/// More ranks than cores, and as root: Open MPI wants to be asked twice for either.
ShellEnding mpirun(int ranks, const std::string& words) {
  return shell(
      "exec env OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1 "
      "OMPI_MCA_mpi_yield_when_idle=1 OMPI_MCA_btl_vader_single_copy_mechanism=none timeout 300 " +
      std::string(GONOGO_MPIEXEC) + " -n " + std::to_string(ranks) + " " + GONOGO_DIVIDED_PROGRAM + " " + words);
}

std::unique_ptr<sim::Simulation> in_one_piece(const DividedScene& scene) {
  return sim::make_simulation(sim::Backend::cpu, {scene.world}, scene.settings, 1);
}

}  // namespace

TEST_CASE("1, 2, 3 and 4 processes give the bits of a world in one piece after 200 steps") {
  for (const char* name : {"tank", "wheel", "mixing"}) {
    const DividedScene scene = divided_scene(name);
    const auto simulation = in_one_piece(scene);
    take_steps(*simulation, scene, 0, kSteps);
    const std::string expected = md5(all_bytes(*simulation, scene));
    for (const int ranks : {1, 2, 3, 4}) {
      const ShellEnding run = mpirun(ranks, std::string(name) + " 0 " + std::to_string(kSteps));
      CAPTURE(name, ranks, run.output);
      REQUIRE(run.status == 0);
      CHECK(contains(run.output, expected + " of " + std::to_string(ranks) + " ranks"));
    }
  }
}

TEST_CASE("a checkpoint of two processes continues on one and on three with the same bits") {
  const TemporaryFolder folder;
  const DividedScene scene = divided_scene("tank");
  const std::string half = std::to_string(kHalf), hash = sim::scene_hash(scene.world, scene.settings);
  const auto through = in_one_piece(scene);
  take_steps(*through, scene, 0, kSteps);
  const std::string expected = md5(all_bytes(*through, scene));
  for (const char* name : {"half.h5", "parts.h5"}) {
    const std::string file = (folder / name).string();
    const ShellEnding first = mpirun(2, "tank 0 " + half + " - " + file);
    CAPTURE(name, first.output);
    REQUIRE(first.status == 0);
    const Hdf5Reader in(file);
    REQUIRE(sim::has_parts(in) == (std::string(name) == "parts.h5"));
    const auto resumed = in_one_piece(scene);
    resumed->restore(0, sim::has_parts(in) ? sim::read_parts(in, hash) : sim::read_snapshot(in, hash));
    take_steps(*resumed, scene, kHalf, kSteps - kHalf);
    CHECK(md5(all_bytes(*resumed, scene)) == expected);
    const ShellEnding rest = mpirun(3, "tank " + half + " " + half + " " + file);
    CAPTURE(rest.output);
    CHECK(contains(rest.output, expected + " of 3 ranks"));
  }
}

TEST_CASE("a lost process ends the job with its sentence") {
  const ShellEnding run = mpirun(3, "tank 0 20 lose");
  CHECK(run.status != 0);
  CHECK(run.status != 124);  // not by the time limit
  CHECK(contains(run.output, "rank 1 is lost"));
}

TEST_CASE("a killed process ends the others in time") {
  const auto start = std::chrono::steady_clock::now();
  const ShellEnding run = mpirun(3, "tank 0 20 kill");
  CAPTURE(run.output);
  CHECK(run.status != 0);
  CHECK(run.status != 124);
  CHECK_FALSE(contains(run.output, "of 3 ranks"));
  CHECK(std::chrono::steady_clock::now() - start < std::chrono::seconds(60));
}
