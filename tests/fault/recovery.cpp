// The main job interrupted, killed, repeated and continued: nothing is lost, nothing is done twice, same bits.
#include <algorithm>
#include <csignal>
#include <map>

#include "base/files/file.h"
#include "pipeline/campaign/engine/campaign.h"
#include "tests/fault/program.h"
#include "tests/fault/study_folder.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"

namespace gonogo {
namespace fs = std::filesystem;
namespace {

/// Hash of every result, by name. Trials are kept in the order in which they ended, so their journal is no result.
std::map<std::string, std::string> results(const StudyFolder& s) {
  std::map<std::string, std::string> hashes;
  for (const auto& file : files_below(s.out()))
    if (file.rfind("trials/", 0) != 0) hashes[file] = file_hash(s.out() / file);
  return hashes;
}

/// Trials that are on disk by now.
std::size_t finished_trials(const StudyFolder& s) {
  for (const auto& file : files_below(s.out()))
    if (file.rfind("trials/", 0) == 0 && fs::path(file).filename() == "campaign.json")
      return campaign::campaign_status((s.out() / file).parent_path()).done;
  return 0;
}

void run_to_the_end(const StudyFolder& s) {
  const Ending ending = run_gonogo(s.run_words());
  INFO(ending.err);
  REQUIRE(ending.exit_code == 0);
  CHECK(contains(ending.out, "index.html"));
}

TEST_CASE("a second run does nothing and a change redoes what depends on it") {
  StudyFolder s;
  run_to_the_end(s);
  const auto first = results(s);
  CHECK(first.count("dataset.h5") == 1);
  CHECK(first.count("model.h5") == 1);
  CHECK(first.count("map/go.tif") == 1);
  const Ending second = run_gonogo(s.run_words());
  CHECK(second.exit_code == 0);
  CHECK(second.err == "campaign: up to date\ntrain: up to date\nmap: up to date\n");
  CHECK(results(s) == first);

  s.study["map"]["draws"] = 8;
  s.write();
  CHECK(contains(run_gonogo(s.run_words()).err, "train: up to date\nmap: again, because these changed: map\n"));
  s.study["learning"]["hidden"] = 3;
  s.write();
  const Ending relearnt = run_gonogo(s.run_words());
  CHECK(contains(relearnt.err, "campaign: up to date\ntrain: again, because these changed: learning\n"));
  CHECK(contains(relearnt.err, "map: again, because these changed: model.h5\n"));
}

TEST_CASE("one thread and two give the same bits") {
  const StudyFolder one, two;
  REQUIRE(run_gonogo({"run", one.path("study.json"), "--out", one.out(), "--threads", "1"}).exit_code == 0);
  REQUIRE(run_gonogo({"run", two.path("study.json"), "--out", two.out(), "--threads", "2"}).exit_code == 0);
  for (const char* file :
       {"dataset.h5", "model.h5", "map/go.tif", "map/p_go.tif", "map/reason.tif", "map/map.png", "map/index.html"}) {
    INFO(file);
    CHECK(file_hash(one.out() / file) == file_hash(two.out() / file));
  }
}

TEST_CASE("interrupted by ctrl-c") {
  const StudyFolder undisturbed, s;
  run_to_the_end(undisturbed);
  RunOptions interrupt;
  interrupt.signal = SIGINT;
  interrupt.when = [&] { return finished_trials(s) >= 2; };
  std::vector<std::string> words = s.run_words();
  words.push_back("--json");
  check_json_refusal(run_gonogo(words, interrupt), 130, "interrupted", {"interrupted", "kept"});
  check_nothing_half_written(s.out());
  CHECK_FALSE(fs::exists(s.out() / "dataset.h5"));
  const std::size_t kept = finished_trials(s);
  CHECK(kept >= 2);
  run_to_the_end(s);
  CHECK(finished_trials(s) == 6);
  CHECK(file_hash(s.out() / "dataset.h5") == file_hash(undisturbed.out() / "dataset.h5"));
}

TEST_CASE("killed at several moments") {
  const StudyFolder undisturbed, s;
  run_to_the_end(undisturbed);
  for (const std::size_t trials : {1, 3, 5}) {
    RunOptions kill;
    kill.signal = SIGKILL;
    kill.when = [&] { return finished_trials(s) >= trials; };
    CHECK(run_gonogo(s.run_words(), kill).signal == SIGKILL);
    CHECK_FALSE(fs::exists(s.out() / "dataset.h5"));
  }
  run_to_the_end(s);
  check_nothing_half_written(s.out());
  for (const char* file : {"dataset.h5", "model.h5", "map/go.tif", "map/p_go.tif"})
    CHECK(file_hash(s.out() / file) == file_hash(undisturbed.out() / file));
}

TEST_CASE("truncated hdf5") {
  const StudyFolder s;
  run_to_the_end(s);
  const auto whole = results(s);
  for (const char* file : {"dataset.h5", "model.h5"}) {
    const std::string content = read_file(s.out() / file);
    write_file_atomically(s.path(file), content.substr(0, content.size() / 2));
  }
  const std::string dataset = s.path("dataset.h5"), model = s.path("model.h5");
  check_refusal(run_gonogo({"dataset", "summary", dataset}), 2, {"dataset.h5"});
  check_refusal(run_gonogo({"train", "--dataset", dataset, "--out", s.path("new.h5")}), 2, {"dataset.h5"});
  CHECK_FALSE(fs::exists(s.path("new.h5")));
  check_refusal(run_gonogo({"map", "--model", model, "--study", s.path("study.json"), "--out", s.path("map")}), 2,
                {"model.h5"});
  CHECK(files_below(s.path("map")).empty());

  // A damaged result of a run is made again, from the trials that are kept.
  fs::copy_file(dataset, s.out() / "dataset.h5", fs::copy_options::overwrite_existing);
  const Ending mended = run_gonogo(s.run_words());
  CHECK(contains(mended.err, "campaign: again, because these are missing or were altered: dataset.h5"));
  CHECK(results(s) == whole);
}

TEST_CASE("a second run in the same folder at the same time") {
  const StudyFolder s;
  Ending second;
  bool asked = false;
  RunOptions meanwhile;
  meanwhile.signal = SIGINT;
  meanwhile.when = [&] {
    if (finished_trials(s) < 1) return false;
    if (!asked) second = run_gonogo(s.run_words());
    asked = true;
    return true;
  };
  // The first run may have ended by itself while the second one was being refused.
  const int first = run_gonogo(s.run_words(), meanwhile).exit_code;
  CHECK((first == 130 || first == 0));
  check_refusal(second, 2, {"another run is using this folder"});
}

}  // namespace
}  // namespace gonogo
