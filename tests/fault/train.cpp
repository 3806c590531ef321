// gonogo train, interrupted: what was finished is kept, and the same command continues from there.
#include <chrono>
#include <csignal>

#include "base/files/file.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "tests/fault/program.h"
#include "tests/pipeline/outcome/synthetic_trials.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"

namespace gonogo {
namespace {

namespace fs = std::filesystem;

const std::string kStudy = R"({"study": "t", "seed": 3, "learning": {"epochs": 120, "folds": 3}, "design":
  {"method": "sobol", "points": 20, "ranges": {"slope_along": [0, 35], "cohesion": [0, 5]},
   "fixed": {"slope_across": 0, "friction_angle": 30, "relative_density": 0.5, "payload": 0, "tyre_friction": 0.8,
             "bed_depth": 0.3, "commanded_speed": 1}}})";

std::size_t count_with(const fs::path& folder, const std::string& word) {
  if (!fs::is_directory(folder)) return 0;
  std::size_t count = 0;
  for (const std::string& file : files_below(folder))
    count += file.find(word) != std::string::npos && file.find("tmp") == std::string::npos;
  return count;
}

TEST_CASE("an interrupted training continues with the next fold, then with the next member") {
  const TemporaryFolder folder;
  campaign::write_dataset(folder / "d.h5", {outcome::synthetic_trials(120, 1), {}});
  write_file_atomically(folder / "study.json", kStudy);
  const auto words = [&](const std::string& model) {
    return std::vector<std::string>{"train", "--dataset",    folder / "d.h5", "--study", folder / "study.json",
                                    "--out", folder / model, "--members",     "3"};
  };
  REQUIRE(run_gonogo(words("whole.h5")).exit_code == 0);
  CHECK_FALSE(fs::exists(folder / "whole.h5.unfinished"));

  const fs::path kept = folder / "m.h5.unfinished";
  for (const char* part : {".fold0", ".member1"}) {
    RunOptions interrupt;
    interrupt.signal = SIGINT;
    interrupt.when = [&] { return count_with(kept, part) > 0; };
    const Ending ending = run_gonogo(words("m.h5"), interrupt);
    INFO(part << "\n" << ending.err);
    REQUIRE(ending.exit_code == 130);
    CHECK(count_with(kept, part) == 1);
  }
  const fs::file_time_type member = fs::last_write_time(folder / "m.member1.h5");
  const Ending last = run_gonogo(words("m.h5"));
  REQUIRE(last.exit_code == 0);
  CHECK(fs::last_write_time(folder / "m.member1.h5") == member);
  CHECK_FALSE(fs::exists(kept));
  for (const char* suffix : {".h5", ".member1.h5", ".member2.h5", ".member3.h5"})
    CHECK(file_hash(folder / ("m" + std::string(suffix))) == file_hash(folder / ("whole" + std::string(suffix))));
}

TEST_CASE("training through the emulated annealer tells how long it will still take") {
  const TemporaryFolder folder;
  campaign::write_dataset(folder / "d.h5", {outcome::synthetic_trials(120, 1), {}});
  std::string study = kStudy;
  const std::string epochs = "\"epochs\": 120";
  study.replace(study.find(epochs), epochs.size(), R"("epochs": 4000, "sampler": "emulator")");
  write_file_atomically(folder / "study.json", study);
  RunOptions interrupt;
  interrupt.signal = SIGINT;
  const auto start = std::chrono::steady_clock::now();
  interrupt.when = [&] { return std::chrono::steady_clock::now() - start > std::chrono::seconds(25); };
  const Ending ending = run_gonogo(
      {"train", "--dataset", folder / "d.h5", "--study", folder / "study.json", "--out", folder / "m.h5"}, interrupt);
  INFO(ending.err);
  CHECK(ending.exit_code == 130);
  CHECK(contains(ending.err, "/16000 epochs"));
  CHECK(contains(ending.err, " min left, machine 1 of 4"));
}

}  // namespace
}  // namespace gonogo
