// The Slurm engine against a real Slurm of one node on this machine.
#include <unistd.h>

#include <cstdlib>

#include "base/files/file.h"
#include "pipeline/campaign/engine/cluster/slurm.h"
#include "tests/fault/cheap_campaign.h"
#include "tests/fault/shell.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"

namespace gonogo::campaign {

namespace fs = std::filesystem;
namespace {

constexpr int kPoints = 100;  // 110 trials

class Cluster {
 public:
  Cluster() {
    const ShellEnding start = shell(script() + " start " + folder_.path().string());
    INFO(start.output);
    REQUIRE(start.status == 0);
    ::setenv("SLURM_CONF", (folder_ / "slurm.conf").c_str(), 1);
  }
  ~Cluster() { shell(script() + " stop " + folder_.path().string()); }

 private:
  static std::string script() { return GONOGO_SLURM_CLUSTER; }
  TemporaryFolder folder_;
};

std::string words(const std::string& what, const fs::path& place, int milliseconds) {
  return std::string(GONOGO_CAMPAIGN_PROGRAM) + " " + what + " " + place.string() + " " + std::to_string(kPoints) +
         " 1 " + std::to_string(milliseconds) + " normal 1 16";
}

template <class Condition>
bool wait_for(Condition condition) {
  for (int i = 0; i < 600; ++i) {
    if (condition()) return true;
    ::usleep(100000);
  }
  return false;
}

bool is_over(const fs::path& place) { return slurm_state(place).empty(); }

}  // namespace

TEST_CASE("a job array computes a campaign; cancelled, it is submitted again: the bits of a loop over the trials") {
  const Cluster cluster;
  const TemporaryFolder folder;
  const fs::path place = folder / "a";

  const ShellEnding submitted = shell(words("submit", place, 50));
  CAPTURE(submitted.output);
  REQUIRE(submitted.status == 0);
  CHECK(contains(submitted.output, "shards 7 tasks 3"));
  CHECK(contains(shell(words("submit", place, 50)).output, "was submitted already"));
  REQUIRE(wait_for([&] { return campaign_status(place).done >= 20; }));
  CHECK(campaign_status(place).use == FolderUse::tasks);
  CHECK(contains(shell(words("run", place, 0)).output, "tasks of this campaign are at work"));
  CHECK(contains(slurm_state(place), "running"));

  const std::string job = submitted.output.substr(4, submitted.output.find(' ', 4) - 4);
  REQUIRE(shell("scancel --signal=KILL --full " + job + "; scancel " + job).status == 0);
  REQUIRE(wait_for([&] { return is_over(place) && folder_use(place) == FolderUse::none; }));
  const std::size_t kept = campaign_status(place).done;
  CHECK(kept >= 20);
  CHECK(kept < 110);
  const ShellEnding early = shell(words("collect", place, 0));
  CHECK(early.status == 2);
  CHECK(contains(early.output, std::to_string(110 - kept) + " trials of "));
  CHECK_FALSE(fs::exists(place / "dataset.h5"));

  REQUIRE(shell(words("submit", place, 0)).status == 0);
  REQUIRE(wait_for([&] { return is_over(place) && campaign_status(place).done == 110; }));
  CHECK(campaign_status(place).committed_shards == 7);
  REQUIRE(wait_for([&] { return folder_use(place) == FolderUse::none; }));
  const ShellEnding collected = shell(words("collect", place, 0));
  CAPTURE(collected.output);
  REQUIRE(collected.status == 0);
  CHECK(contains(collected.output, "trials 110 computed 0 reused 110"));
  CHECK(read_file(place / "dataset.h5") == expected_bytes(kPoints));
  CHECK(contains(shell(words("submit", place, 0)).output, "job  shards 0 tasks 0"));
}

TEST_CASE("without Slurm, submitting is one sentence that says where the script is") {
  const TemporaryFolder folder;
  const ShellEnding refused = shell("PATH=/nowhere " + words("submit", folder / "a", 0));
  CHECK(refused.status == 1);
  CHECK(contains(refused.output, "sbatch refused the job"));
  CHECK(contains(refused.output, "not found"));
  CHECK(contains(refused.output, "job.sh"));
}

}  // namespace gonogo::campaign
