// The MPI engine under a real mpirun.
#include <unistd.h>

#include <cstdlib>
#include <thread>

#include "base/files/file.h"
#include "tests/fault/cheap_campaign.h"
#include "tests/fault/shell.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"

namespace gonogo::app {
using namespace campaign;

namespace fs = std::filesystem;
namespace {

constexpr int kPoints = 100;  // 110 trials

/// More ranks than cores, and as root: Open MPI wants to be asked twice for either.
std::string mpirun(int ranks, const fs::path& place, int milliseconds, const std::string& behaviour = "normal") {
  return "exec env OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1 "
         "OMPI_MCA_btl_vader_single_copy_mechanism=none " +
         std::string(GONOGO_MPIEXEC) + " -n " + std::to_string(ranks) + " " + GONOGO_CAMPAIGN_PROGRAM + " mpi " +
         place.string() + " " + std::to_string(kPoints) + " 1 " + std::to_string(milliseconds) + " " + behaviour +
         " 1 16";
}

}  // namespace

TEST_CASE("2 and 4 MPI ranks give the bits of a loop over the trials") {
  const TemporaryFolder folder;
  for (const int ranks : {2, 4}) {
    const fs::path place = folder / std::to_string(ranks);
    const ShellEnding run = shell(mpirun(ranks, place, 0));
    CAPTURE(run.output);
    REQUIRE(run.status == 0);
    CHECK(contains(run.output, "trials 110 computed 110 reused 0"));
    CHECK(read_file(place / "dataset.h5") == expected_bytes(kPoints));
  }
}

TEST_CASE("an MPI job that is killed is continued by the next one") {
  const TemporaryFolder folder;
  const fs::path place = folder / "a";
  const ShellEnding killed =
      shell("timeout -s KILL 60 sh -c '" + mpirun(3, place, 30).substr(5) + " & job=$!; " + "while ! [ -s " +
            place.string() + "/trials/local.csv ]; do sleep 0.1; done; " + "sleep 0.5; kill -9 $job; wait $job'");
  CHECK(killed.status != 0);
  for (int i = 0; i < 200 && folder_use(place) != FolderUse::none; ++i) ::usleep(50000);
  REQUIRE(folder_use(place) == FolderUse::none);
  const std::size_t kept = campaign_status(place).done;
  CHECK(kept > 0);
  CHECK(kept < 110);
  const ShellEnding rest = shell(mpirun(4, place, 0));
  CAPTURE(rest.output);
  REQUIRE(rest.status == 0);
  CHECK(contains(rest.output, "reused " + std::to_string(kept) + " "));
  CHECK(read_file(place / "dataset.h5") == expected_bytes(kPoints));
}

TEST_CASE("trouble of an MPI rank stops the job with its sentence, and one rank is too few") {
  const TemporaryFolder folder;
  const ShellEnding refused = shell(mpirun(3, folder / "a", 0, "refuse:3"));
  CHECK(refused.status == 2);
  CHECK(contains(refused.output, "soil.json: cohesion: value -1 is outside the allowed range"));
  const ShellEnding alone = shell(mpirun(1, folder / "b", 0));
  CHECK(alone.status == 2);
  CHECK(contains(alone.output, "mpirun -n 2"));
}

}  // namespace gonogo::app
