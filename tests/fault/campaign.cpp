#include "pipeline/campaign/campaign.h"

#include <fcntl.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <fstream>
#include <functional>
#include <memory>

#include "base/file.h"
#include "base/random.h"
#include "pipeline/campaign/folder.h"
#include "pipeline/campaign/journal.h"
#include "pipeline/dataset/row.h"
#include "tests/fault/cheap_campaign.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/trials.h"

namespace gonogo::pipeline {
namespace fs = std::filesystem;
namespace {

constexpr int kPoints = 200;  // 220 trials
constexpr int kTrials = 220;
constexpr uid_t kNobody = 65534;

/// A run of campaign_program. `before` is called in the new process.
struct Run {
  pid_t pid;
  fs::path log;

  Run(
      const fs::path& folder, int points, int workers, int milliseconds, const std::string& behaviour = "normal",
      const std::function<void()>& before = [] {}, int places = 1, const std::string& per_shard = "64")
      : log(folder.string() + ".log") {
    const std::vector<std::string> words{GONOGO_CAMPAIGN_PROGRAM,
                                         "run",
                                         folder.string(),
                                         std::to_string(points),
                                         std::to_string(workers),
                                         std::to_string(milliseconds),
                                         behaviour,
                                         std::to_string(places),
                                         per_shard};
    pid = ::fork();
    if (pid != 0) return;
    const int out = ::open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    ::dup2(out, STDOUT_FILENO);
    ::dup2(out, STDERR_FILENO);
    std::vector<char*> argv;
    for (const std::string& word : words) argv.push_back(const_cast<char*>(word.c_str()));
    argv.push_back(nullptr);
    before();
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }

  bool ended(int& status) const { return ::waitpid(pid, &status, WNOHANG) == pid; }

  /// Exit status, or minus the signal that ended it.
  int wait() const {
    int status = 0;
    ::waitpid(pid, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }

  std::string output() const { return read_file(log); }
};

/// Running, not just waiting for somebody to take note of its end.
bool is_alive(pid_t process) {
  std::ifstream stat("/proc/" + std::to_string(process) + "/stat");
  std::string pid, name, state;
  return (stat >> pid >> name >> state) && state != "Z";
}

std::vector<pid_t> children_of(pid_t parent) {
  std::vector<pid_t> children;
  for (const auto& entry : fs::directory_iterator("/proc")) {
    std::ifstream stat(entry.path() / "stat");
    std::string pid, name, state;
    pid_t ppid = 0;
    if (stat >> pid >> name >> state >> ppid && ppid == parent && state != "Z") children.push_back(std::stoi(pid));
  }
  return children;
}

std::string dataset_bytes(const fs::path& folder) { return read_file(folder / "dataset.h5"); }

void sleep_ms(int milliseconds) { ::usleep(useconds_t(milliseconds) * 1000); }

bool wait_until(const std::function<bool()>& condition) {
  for (int i = 0; i < 5000; ++i) {
    if (condition()) return true;
    sleep_ms(2);
  }
  return false;
}

/// Trials that are on disk by now; none before the campaign has begun.
std::size_t finished_trials(const fs::path& folder) {
  std::error_code ec;
  return fs::exists(folder / "campaign.json", ec) ? campaign_status(folder).done : 0;
}

std::vector<fs::path> shard_files(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code ec;
  for (const auto& entry : fs::directory_iterator(shard_folder(folder), ec))
    if (entry.path().extension() == ".h5" && entry.path().filename().string()[0] != '.') files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

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

/// A campaign of 22 trials that was stopped after the 15th, in the journal, and its whole journal.
std::string stopped_campaign(const fs::path& place) {
  REQUIRE(Run(place, 20, 1, 0, "crash:15").wait() == 1);
  return read_file(journal_path(place));
}

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
  mend("depend on other inputs than this campaign's", 64);
  fs::remove_all(shard_folder(place));  // and the dataset stays as it is
  mend("", 220);
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
}  // namespace gonogo::pipeline
