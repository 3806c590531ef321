// Takes steps of a world of divided_scenes.h on the ranks of an MPI job. Rank 0 prints the MD5 sum of all bytes.
// "lose": rank 1 then fails, while the others go on.
//   divided_program <scene> <first step> <steps> [<checkpoint to read> | - | lose] [<checkpoint to write>]
#include <cstdio>
#include <string>
#include <vector>

#include "base/ranks/mpi.h"
#include "sim/io/checkpoint.h"
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
  if (words.size() > 3 && words[3] != "-" && words[3] != "lose")
    simulation->restore(0, sim::load_checkpoint(words[3], hash));
  test::take_steps(*simulation, scene, std::stoi(words.at(1)), std::stoi(words.at(2)));
  if (words.size() > 3 && words[3] == "lose" && ranks->rank() == 1) throw DeviceError("rank 1 is lost");
  const std::string sum = md5(test::all_bytes(*simulation, scene));
  const sim::Snapshot last = simulation->snapshot(0);
  if (ranks->rank() != 0) return;
  if (words.size() > 4) sim::save_checkpoint(words[4], last, hash);
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
