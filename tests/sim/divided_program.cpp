// Takes steps of a world of divided_scenes.h on the ranks of an MPI job. Rank 0 prints the MD5 sum of all bytes.
// "lose": rank 1 then fails, while the others go on; "kill": it is killed.
//   divided_program <scene> <first step> <steps> [<checkpoint to read> | - | lose | kill] [<checkpoint to write>]
// A checkpoint whose name ends in "parts.h5" is written by parts.
#include <csignal>
#include <cstdio>
#include <string>
#include <vector>

#include "base/ranks/mpi.h"
#include "sim/io/checkpoint.h"
#include "sim/io/part_files.h"
#include "sim/simulation/parts/divided.h"
#include "tests/sim/divided_scenes.h"
#include "tests/support/md5.h"

namespace {

using namespace gonogo;

void run(const std::vector<std::string>& words) {
  const test::DividedScene scene = test::divided_scene(words.at(0));
  const std::unique_ptr<Ranks> ranks = mpi_ranks();
  const auto simulation = sim::make_divided_simulation(sim::Backend::cpu, scene.world, scene.settings, 1, *ranks);
  const std::string hash = sim::scene_hash(scene.world, scene.settings);
  const std::string from = words.size() > 3 ? words[3] : "-";
  const bool ends = from == "lose" || from == "kill";
  if (from != "-" && !ends) {
    const Hdf5Reader in(from);
    simulation->restore(0, sim::has_parts(in) ? sim::read_parts(in, hash) : sim::read_snapshot(in, hash));
  }
  test::take_steps(*simulation, scene, std::stoi(words.at(1)), std::stoi(words.at(2)));
  if (ends && ranks->rank() == 1) from == "kill" ? (void)std::raise(SIGKILL) : throw DeviceError("rank 1 is lost");
  const std::string sum = md5(test::all_bytes(*simulation, scene));
  const sim::Snapshot last = simulation->snapshot(0);
  const std::string to = words.size() > 4 ? words[4] : "";
  const bool by_parts = to.ends_with("parts.h5");
  if (by_parts) sim::save_checkpoint_by_parts(to, *sim::in_parts(*simulation), hash, ranks->rank() == 0);
  if (ranks->rank() != 0) return;
  if (!to.empty() && !by_parts) sim::save_checkpoint(to, last, hash);
  std::printf("%s of %d ranks\n", sum.c_str(), ranks->count());
}

}  // namespace

int main(int argc, char** argv) {
  try {
    run({argv + 1, argv + argc});
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "divided_program: %s\n", error.what());
    end_mpi_job(1);
  }
}
