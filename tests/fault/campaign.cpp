// Campaigns that nothing disturbs, and those that are refused.
#include "pipeline/campaign/engine/campaign.h"

#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>

#include "pipeline/campaign/engine/ledger.h"
#include "tests/fault/campaign_run.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/trials.h"

namespace gonogo::campaign {

namespace {

constexpr uid_t kNobody = 65534;

TEST_CASE("1, 2 and 4 workers give the same dataset bits as calling the trials in a loop") {
  const TemporaryFolder folder;
  const std::string expected = expected_bytes(kPoints);
  for (const int workers : {1, 2, 4}) {
    const fs::path place = folder / std::to_string(workers);
    const Run run(place, kPoints, workers, 0);
    REQUIRE(run.wait() == 0);
    CHECK(dataset_bytes(place) == expected);
    CHECK(contains(run.output(), "trials 220 computed 220 reused 0"));
  }
}

TEST_CASE("workers with 1, 3 and 700 places give the same dataset bits") {
  const TemporaryFolder folder;
  const std::string expected = expected_bytes(1000);
  for (const int places : {1, 3, 700}) {  // with 700, more is under way than a socket holds
    const fs::path place = folder / std::to_string(places);
    const Run run(
        place, 1000, 2, 0, "normal", [] {}, places);
    REQUIRE(run.wait() == 0);
    CHECK(dataset_bytes(place) == expected);
    CHECK(contains(run.output(), "trials 1100 computed 1100 reused 0"));
  }
}

TEST_CASE("a second run computes nothing and leaves the dataset untouched") {
  const TemporaryFolder folder;
  REQUIRE(Run(folder / "a", kPoints, 2, 0).wait() == 0);
  const auto time = fs::last_write_time(folder / "a/dataset.h5");
  const Run again(folder / "a", kPoints, 2, 0);
  REQUIRE(again.wait() == 0);
  CHECK(contains(again.output(), "computed 0 reused 220"));
  CHECK(fs::last_write_time(folder / "a/dataset.h5") == time);
}

TEST_CASE("a campaign grows and shrinks without computing anything twice") {
  const TemporaryFolder folder;
  REQUIRE(Run(folder / "a", 100, 2, 0).wait() == 0);
  const Run longer(folder / "a", 200, 2, 0);
  REQUIRE(longer.wait() == 0);
  CHECK(contains(longer.output(), "trials 220 computed 110 reused 110"));
  CHECK(dataset_bytes(folder / "a") == expected_bytes(200));
  const Run shorter(folder / "a", 100, 2, 0);
  REQUIRE(shorter.wait() == 0);
  CHECK(contains(shorter.output(), "trials 110 computed 0"));
  CHECK(dataset_bytes(folder / "a") == expected_bytes(100));
}

TEST_CASE("the size of shards changes no bit, and the first run decides it") {
  const TemporaryFolder folder;
  const std::string expected = expected_bytes(60);
  for (const std::string per_shard : {"1", "7", "66", "1000"}) {
    const fs::path place = folder / per_shard;
    const Run run(
        place, 60, 2, 0, "normal", [] {}, 1, per_shard);
    REQUIRE(run.wait() == 0);
    CHECK(dataset_bytes(place) == expected);
  }
  REQUIRE(Run(
              folder / "7", 60, 2, 0, "normal", [] {}, 1, "20")
              .wait() == 0);
  CHECK(campaign_status(folder / "7").shards == 10);
}

TEST_CASE("clocks that are wrong change nothing: files from tomorrow and from long ago") {
  const TemporaryFolder folder;
  const fs::path place = folder / "a";
  stopped_campaign(place);
  const auto now = fs::file_time_type::clock::now();
  fs::last_write_time(journal_path(place), now + std::chrono::hours(24));
  fs::last_write_time(place / "campaign.json", now - std::chrono::hours(24 * 365 * 20));
  fs::last_write_time(place / "campaign.lock", now + std::chrono::hours(24 * 365));
  const Run run(place, 20, 2, 0);
  REQUIRE(run.wait() == 0);
  CHECK(contains(run.output(), "reused 15 "));
  CHECK(dataset_bytes(place) == expected_bytes(20));
}

TEST_CASE("a worker of another version is refused") {
  const TemporaryFolder folder;
  const Run run(folder / "a", 20, 2, 0, "old");
  CHECK(run.wait() == 2);
  CHECK(contains(run.output(), "a worker is another version of the program (0.0.1 (1234))"));
  CHECK(finished_trials(folder / "a") == 0);
}

TEST_CASE("a filesystem without locks is refused, saying so") {
  const TemporaryFolder folder;
  const Run run(folder / "a", 20, 2, 0, "normal", [] { ::setenv("LD_PRELOAD", GONOGO_NO_LOCKS, 1); });
  CHECK(run.wait() == 1);
  CHECK(contains(run.output(), "this filesystem has no locks (No locks available)"));
}

TEST_CASE("a second coordinator in the same folder is refused, and status sees the first") {
  const TemporaryFolder folder;
  const fs::path place = folder / "a";
  const Run first(place, kPoints, 2, 10);
  REQUIRE(wait_until([&] { return finished_trials(place) > 0; }));
  const std::string sentence = input_error([&] { run_campaign(cheap_campaign(place, kPoints)); });
  CHECK(contains(sentence, place.string()));
  CHECK(contains(sentence, "another campaign is at work"));
  const CampaignStatus during = campaign_status(place);
  CHECK(during.use == FolderUse::coordinator);
  CHECK(during.trials == std::size_t(kTrials));
  CHECK(during.done > 0);
  REQUIRE(first.wait() == 0);
  const CampaignStatus after = campaign_status(place);
  CHECK(after.use == FolderUse::none);
  CHECK(after.done == std::size_t(kTrials));
  CHECK(contains(input_error([&] { campaign_status(folder / "nothing"); }), "holds no campaign"));
}

TEST_CASE("other inputs in the same folder are refused, naming what changed") {
  const TemporaryFolder folder;
  REQUIRE(Run(folder / "a", 20, 2, 0).wait() == 0);
  CampaignRequest changed = cheap_campaign(folder / "a", 20);
  changed.depends_on = {{"seed", "3"}, {"trial.step_s", "0.002"}, {"soil.grain_m", "0.03"}};
  const std::string sentence = input_error([&] { run_campaign(changed); });
  CHECK(contains(sentence, (folder / "a").string()));
  CHECK(contains(sentence, "trial.step_s was 0.001, is 0.002"));
  CHECK(contains(sentence, "soil.grain_m is new"));
  CHECK(contains(sentence, "another folder"));
}

TEST_CASE("bad input found by a worker stops the campaign with the worker's sentence") {
  const TemporaryFolder folder;
  const Run run(folder / "a", 20, 2, 0, "refuse:3");
  CHECK(run.wait() == 2);
  CHECK(contains(run.output(), "campaign_program: soil.json: cohesion: value -1 is outside the allowed range"));
}

TEST_CASE("what a trial prints does not disturb the campaign") {
  const TemporaryFolder folder;
  REQUIRE(Run(folder / "a", 20, 2, 0, "print").wait() == 0);
  CHECK(dataset_bytes(folder / "a") == expected_bytes(20));
}

TEST_CASE("a worker program that does not exist is one sentence") {
  const TemporaryFolder folder;
  CampaignRequest request = cheap_campaign(folder / "a", 5);
  request.worker_command = {"/nowhere/gonogo"};
  try {
    run_campaign(request);
    FAIL("nothing was thrown");
  } catch (const DeviceError& error) {
    CHECK(contains(error.what(), "/nowhere/gonogo"));
  }
}

TEST_CASE("no right to write: one sentence that names the folder") {
  const TemporaryFolder folder;
  const fs::path place = folder / "closed";
  fs::create_directory(place);
  ::chmod(folder.path().c_str(), 0755);
  ::chmod(place.c_str(), 0555);
  const pid_t child = ::fork();
  if (child == 0) {
    if (::getuid() == 0 && ::setuid(kNobody) != 0) ::_exit(9);
    const std::string sentence = input_error([&] { run_campaign(cheap_campaign(place, 5)); });
    ::_exit(contains(sentence, place.string()) && contains(sentence, "cannot write here") ? 0 : 1);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  CHECK((WIFEXITED(status) && WEXITSTATUS(status) == 0));
}

}  // namespace
}  // namespace gonogo::campaign
