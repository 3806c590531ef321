// Campaigns that are killed, cut short, damaged or out of disk: the same dataset bits in the end.
#include <sys/mount.h>
#include <sys/resource.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <memory>

#include "base/json/json.h"
#include "base/math/random.h"
#include "pipeline/campaign/engine/campaign.h"
#include "pipeline/campaign/engine/ledger.h"
#include "tests/fault/campaign_run.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/trials.h"

namespace gonogo::campaign {

namespace {

/// Cuts a shard short, or changes one of its bytes.
void damage(const fs::path& file, std::uint64_t draw) {
  std::string bytes = read_file(file);
  const std::size_t at = std::size_t(double(bytes.size()) * random_unit(9, 1, draw));
  if (draw % 2 == 0)
    bytes.resize(at);
  else
    bytes[at] = char(bytes[at] ^ 4);
  std::ofstream(file, std::ios::binary) << bytes;
}

/// No file of this process and those it starts can grow at all.
void no_space() {
  const rlimit none{0, 0};
  ::setrlimit(RLIMIT_FSIZE, &none);
  std::signal(SIGXFSZ, SIG_IGN);
}

/// Kills workers and coordinators of one campaign, 50 in all. Shards are damaged meanwhile, and once the disk is full.
void check_kills(int places) {
  const TemporaryFolder folder;
  const fs::path place = folder / "killed";
  constexpr int kKills = 50, kMilliseconds = 15, kWorkers = 3;
  int points = 400, kills = 0, coordinator_kills = 0, status = -1, damaged = 0;
  const auto restart = [&] {
    return std::make_unique<Run>(
        place, points, kWorkers, kMilliseconds, "normal", [] {}, places, "16");
  };
  auto run = restart();
  for (std::uint64_t draw = 0; kills < kKills; ++draw) {
    sleep_ms(5 + int(40 * random_unit(1, 0, draw)));
    if (run->ended(status)) {  // on a machine where our sleeps take long: more trials, to have something to kill
      REQUIRE(status == 0);
      points += 200;
      run = restart();
      continue;
    }
    const std::vector<pid_t> workers = children_of(run->pid);
    const bool kill_coordinator = random_unit(1, 1, draw) < 0.25;
    if (!kill_coordinator && workers.empty()) continue;
    const std::size_t pick = std::size_t(double(workers.size()) * random_unit(1, 2, draw));
    ::kill(kill_coordinator ? run->pid : workers[pick], SIGKILL);
    ++kills;
    if (!kill_coordinator) continue;
    ++coordinator_kills;
    REQUIRE(run->wait() == -SIGKILL);
    CHECK(wait_until([&] { return std::none_of(workers.begin(), workers.end(), is_alive); }));
    if (const auto shards = shard_files(place); !shards.empty()) {
      damage(shards[draw % shards.size()], draw);
      ++damaged;
    }
    if (coordinator_kills == 3) CHECK(Run(place, points, kWorkers, 0, "normal", no_space, places, "16").wait() == 1);
    run = restart();
  }
  REQUIRE(run->wait() == 0);
  INFO("shards damaged on the way: " << damaged);
  damage(shard_files(place).at(3), 2);
  run = restart();
  REQUIRE(run->wait() == 0);
  CHECK(contains(run->output(), "computed 16 "));
  CHECK(coordinator_kills >= 5);
  CHECK(kills - coordinator_kills >= 20);
  CHECK(dataset_bytes(place) == expected_bytes(points));
  CHECK(finished_trials(place) == std::size_t(points + points / 10));
  CHECK(journals_of(place).empty());
  for (const auto& entry : fs::directory_iterator(place))
    CHECK_FALSE(contains(entry.path().filename().string(), "partial"));
}

TEST_CASE("50 kill -9, damaged shards and a full disk change no bit of the dataset") { check_kills(1); }

TEST_CASE("50 kill -9 of workers that have two trials each change no bit of the dataset") { check_kills(2); }

TEST_CASE("a journal cut anywhere or with a changed byte: the damage is set aside, said and computed again") {
  const TemporaryFolder folder;
  const fs::path place = folder / "a";
  const std::string whole = stopped_campaign(place), expected = expected_bytes(20);
  for (std::uint64_t draw = 0; draw < 6; ++draw) {
    fs::remove_all(shard_folder(place));
    std::ofstream(journal_path(place), std::ios::binary) << whole;
    damage(journal_path(place), draw);
    fs::remove(place / "dataset.h5");
    const Run run(place, 20, 2, 0);
    CAPTURE(draw);
    REQUIRE(run.wait() == 0);
    CHECK(contains(run.output(), "set aside"));
    CHECK(dataset_bytes(place) == expected);
    CHECK(fs::exists(journal_path(place).string() + ".damaged"));
  }
}

TEST_CASE("a shard cut short, changed, exchanged or without its manifest is computed again, which is said") {
  const TemporaryFolder folder;
  const fs::path place = folder / "a";
  REQUIRE(Run(place, kPoints, 2, 0).wait() == 0);
  const std::string expected = expected_bytes(kPoints);
  const std::vector<fs::path> shards = shard_files(place);
  REQUIRE(shards.size() == 4);
  const auto mend = [&](const std::string& said, int computed) {
    const Run run(place, kPoints, 2, 0);
    REQUIRE(run.wait() == 0);
    CAPTURE(run.output());
    CHECK(contains(run.output(), said));
    CHECK(contains(run.output(), "computed " + std::to_string(computed) + " "));
    CHECK(dataset_bytes(place) == expected);
    CHECK(campaign_status(place).committed_shards == 4);
  };
  damage(shards[1], 2);
  mend("bytes, its manifest says", 64);
  damage(shards[1], 3);
  mend("do not match the hash in its manifest", 64);
  fs::remove(shards[2]);
  mend("is missing or cannot be read", 64);
  std::ofstream(shard_folder(place) / "shard-3.json") << "{ \"format\"";
  mend("shard 3 is set aside", 28);
  fs::remove(shard_folder(place) / "shard-0.json");
  mend("", 64);
  fs::remove_all(shard_folder(place));
  mend("", 220);
  std::string manifest = read_file(shard_folder(place) / "shard-1.json");  // as if of another campaign
  manifest[manifest.find("campaign") + 13] ^= 1;
  std::ofstream(shard_folder(place) / "shard-1.json") << manifest;
  mend("does not match the rest of the file", 64);
  fs::remove_all(shard_folder(place));  // and the dataset stays as it is
  mend("", 220);
}

namespace {

/// Flips one bit of some 500 bytes of a JSON file, one at a time. `read` must throw, unless the content is the same:
/// white space.
template <class Read>
void check_flips(const fs::path& file, const Read& read) {
  const std::string whole = read_file(file), content = Json::parse(whole, "file").dump();
  for (std::size_t at = 0; at < whole.size(); at += 1 + whole.size() / 500) {
    std::string bytes = whole;
    bytes[at] = char(bytes[at] ^ (1 << (at % 8)));
    std::string changed;
    try {
      changed = Json::parse(bytes, "file").dump();
    } catch (const InputError&) {
    }
    if (changed == content) continue;
    write_file_atomically(file, bytes);
    INFO(file.string() << " byte " << at);
    CHECK_THROWS_AS(read(), InputError);
  }
  write_file_atomically(file, whole);
  read();
}

}  // namespace

TEST_CASE("one flipped bit anywhere in a journal, a manifest or the campaign's own file is found") {
  const TemporaryFolder folder;
  const fs::path place = folder / "a";
  REQUIRE(Run(place, 20, 1, 0).wait() == 0);
  check_flips(shard_folder(place) / "shard-0.json", [&] { return read_manifest(place, 0); });
  check_flips(place / "campaign.json", [&] { return campaign_status(place); });
  const std::vector<TrialRecord> records = *read_shard(place, 0, read_manifest(place, 0)->campaign);
  write_journal(journal_path(place), records);
  const std::string whole = read_file(journal_path(place));
  for (std::size_t at = 0; at < whole.size(); at += 1 + whole.size() / 500) {
    std::string bytes = whole;
    bytes[at] = char(bytes[at] ^ (1 << (at % 8)));
    write_file_atomically(journal_path(place), bytes);
    const JournalContent content = read_journal(journal_path(place));
    INFO("byte " << at << " of " << whole.size());
    REQUIRE(content.damaged_count > 0);
    REQUIRE(content.records.size() < records.size());
  }
}

TEST_CASE("a truncated dataset is refused by readers and written again by its campaign") {
  const TemporaryFolder folder;
  REQUIRE(Run(folder / "a", 20, 2, 0).wait() == 0);
  const std::string whole = dataset_bytes(folder / "a");
  std::ofstream(folder / "a/dataset.h5", std::ios::binary) << whole.substr(0, whole.size() / 3);
  CHECK(contains(input_error([&] { read_dataset(folder / "a/dataset.h5"); }), "cut short"));
  const Run run(folder / "a", 20, 2, 0);
  REQUIRE(run.wait() == 0);
  CHECK(contains(run.output(), "computed 0"));
  CHECK(dataset_bytes(folder / "a") == whole);
}

/// A campaign that runs into the end of its space, is given more and goes on.
void check_full_disk(const fs::path& place, const std::function<void()>& limit,
                     const std::function<void()>& give_space) {
  const Run full(place, 600, 2, 0, "normal", limit);
  CHECK(full.wait() == 1);
  CHECK(contains(full.output(), "cannot"));
  const std::string output = full.output();
  CHECK(std::count(output.begin(), output.end(), '\n') <= 3);
  const std::size_t kept = finished_trials(place);
  CHECK(kept > 50);
  CHECK_FALSE(fs::exists(place / "dataset.h5"));
  give_space();
  const Run rest(place, 600, 2, 0);
  REQUIRE(rest.wait() == 0);
  CHECK(contains(rest.output(), "reused " + std::to_string(kept) + " "));
  CHECK(dataset_bytes(place) == expected_bytes(600));
}

TEST_CASE("a file size limit: one sentence, nothing lost, goes on afterwards") {
  const TemporaryFolder folder;
  const auto limit = [] {
    const rlimit bytes{100000, 100000};
    ::setrlimit(RLIMIT_FSIZE, &bytes);
    std::signal(SIGXFSZ, SIG_IGN);
  };
  check_full_disk(folder / "a", limit, [] {});
}

TEST_CASE("a full disk: one sentence, nothing lost, goes on when there is space") {
  const TemporaryFolder folder;
  const fs::path disk = folder / "disk";
  fs::create_directory(disk);
  if (::mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=256k") != 0) {
    WARN("no right to mount a small disk here; the file size limit above stands for it");
    return;
  }
  const std::shared_ptr<void> unmount(nullptr, [&](void*) { ::umount2(disk.c_str(), MNT_DETACH); });
  check_full_disk(
      disk, [] {}, [&] { ::mount("tmpfs", disk.c_str(), "tmpfs", MS_REMOUNT, "size=8m"); });
}

TEST_CASE("Ctrl-C: exit status 130, workers gone, the rest later") {
  const TemporaryFolder folder;
  const fs::path place = folder / "a";
  const Run run(place, kPoints, 2, 10);
  REQUIRE(wait_until([&] { return finished_trials(place) > 10; }));
  const std::vector<pid_t> workers = children_of(run.pid);
  CHECK(workers.size() == 2);
  ::kill(run.pid, SIGINT);
  CHECK(run.wait() == 130);
  CHECK(std::none_of(workers.begin(), workers.end(), is_alive));
  const std::size_t kept = finished_trials(place);
  CHECK(kept < std::size_t(kTrials));
  const Run rest(place, kPoints, 2, 0);
  REQUIRE(rest.wait() == 0);
  CHECK(contains(rest.output(), "reused " + std::to_string(kept) + " "));
  CHECK(dataset_bytes(place) == expected_bytes(kPoints));
}

TEST_CASE("a trial that crashes stops the campaign with its number; the others are kept") {
  const TemporaryFolder folder;
  const Run run(folder / "a", 20, 1, 0, "crash:7");
  CHECK(run.wait() == 1);
  CHECK(contains(run.output(), "trial 7 was killed by signal 6"));
  CHECK(contains(run.output(), "second time"));
  CHECK(finished_trials(folder / "a") == 7);
  REQUIRE(Run(folder / "a", 20, 1, 0).wait() == 0);
  CHECK(dataset_bytes(folder / "a") == expected_bytes(20));
}

TEST_CASE("a trial that crashes in company is found, and the others are kept") {
  const TemporaryFolder folder;
  const Run run(
      folder / "a", 60, 2, 0, "crash:7", [] {}, 16);
  CHECK(run.wait() == 1);
  CHECK(contains(run.output(), "campaign_program: campaign: the worker of trial 7 was killed by signal 6"));
  CHECK(contains(run.output(), "second time"));
  CHECK(contains(run.output(), " more was killed by signal 6"));
  CHECK(finished_trials(folder / "a") >= 7);
  CHECK(finished_trials(folder / "a") < 66);
  REQUIRE(Run(
              folder / "a", 60, 2, 0, "normal", [] {}, 16)
              .wait() == 0);
  CHECK(dataset_bytes(folder / "a") == expected_bytes(60));
}

}  // namespace
}  // namespace gonogo::campaign
