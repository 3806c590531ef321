// Ctrl-C and SIGTERM at thirty moments of each long command, and a limit on the size of files.
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>

#include "base/files/file.h"
#include "tests/fault/program.h"
#include "tests/fault/study_folder.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"

namespace gonogo {
namespace fs = std::filesystem;
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kUntilHandlers = 0.5;  // that a loaded machine may take to start the program [s]

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// Runs a command with a signal at each of thirty moments of its length; `fresh` makes its words in a new folder. It
/// must end as the promise says, 130 or 0, and never by the signal once its handler stands.
template <class Fresh>
void interrupt(const Fresh& fresh) {
  constexpr int moments = 30;
  const auto start = Clock::now();
  REQUIRE(run_gonogo(fresh(0)).exit_code == 0);
  const double whole = seconds_since(start);
  int stopped = 0;
  for (int k = 0; k < moments; ++k) {
    const std::vector<std::string> words = fresh(k + 1);
    RunOptions options;
    options.signal = k % 2 == 0 ? SIGINT : SIGTERM;
    const auto begun = Clock::now();
    const double moment = whole * (k + 1) / (moments + 1);
    options.when = [&] { return seconds_since(begun) >= moment; };
    const Ending ending = run_gonogo(words, options);
    INFO("moment " << moment << " s of " << whole << " s\n" << ending.err);
    if (ending.signal == options.signal && moment < kUntilHandlers) continue;
    REQUIRE(ending.signal == 0);
    REQUIRE((ending.exit_code == 130 || ending.exit_code == 0));
    if (ending.exit_code != 130) continue;
    CHECK(contains(ending.err, "gonogo: interrupted"));
    ++stopped;
  }
  CHECK(stopped > moments / 2);
}

std::vector<std::string> ground_words(const StudyFolder& study) {
  return {"--model", "hmmwv",     "--dem", study.path("elevation.asc"), "--soil", "loam", "--moisture",
          "moist",   "--threads", "2"};
}

}  // namespace

TEST_CASE("a map ends at once wherever it is interrupted and leaves no half map") {
  StudyFolder study;
  study.write();
  const TemporaryFolder folder;
  interrupt([&](int k) {
    if (k > 1)
      CHECK(fs::exists(folder / std::to_string(k - 1) / "map.json") ==
            fs::exists(folder / std::to_string(k - 1) / "index.html"));
    std::vector<std::string> words = ground_words(study);
    words.insert(words.begin(), "map");
    words.insert(words.end(), {"--out", folder / std::to_string(k)});
    return words;
  });
}

TEST_CASE("a run of trials and training and a map ends wherever it is interrupted and goes on") {
  std::vector<std::unique_ptr<StudyFolder>> studies;
  interrupt([&](int) {
    studies.push_back(std::make_unique<StudyFolder>());
    studies.back()->write();
    return studies.back()->run_words();
  });
  for (const int k : {5, 15, 25}) CHECK(run_gonogo(studies[std::size_t(k)]->run_words()).exit_code == 0);
}

TEST_CASE("a limit on the size of files is told in a sentence and leaves no partial map") {
  StudyFolder study;
  study.write();
  for (const rlim_t bytes : {1000, 20'000, 100'000}) {
    const TemporaryFolder folder;
    std::vector<std::string> words = ground_words(study);
    words.insert(words.begin(), "map");
    words.insert(words.end(), {"--out", folder / "map"});
    RunOptions options;
    options.before = [bytes] {
      const rlimit limit{bytes, bytes};
      setrlimit(RLIMIT_FSIZE, &limit);
    };
    const Ending ending = run_gonogo(words, options);
    INFO(bytes << " " << ending.err);
    CHECK(ending.signal == 0);
    CHECK(ending.exit_code == 1);
    CHECK_FALSE(fs::exists(folder / "map/map.json"));
    CHECK_FALSE(fs::exists(folder / "map/index.html"));
  }
}

}  // namespace gonogo
