// Campaigns whose workers have several trials side by side, killed: trials go on from where they were saved.
#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <map>

#include "base/files/file.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "pipeline/campaign/engine/campaign.h"
#include "pipeline/campaign/engine/folder.h"
#include "pipeline/campaign/trial/watch.h"
#include "tests/fault/program.h"
#include "tests/fault/study_folder.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"

namespace gonogo {
namespace fs = std::filesystem;
namespace {

std::vector<std::string> campaign_words(const StudyFolder& s, const fs::path& out, int workers, int places) {
  return {"campaign",
          "run",
          s.path("study.json"),
          "--out",
          out,
          "--workers",
          std::to_string(workers),
          "--places",
          std::to_string(places),
          "--checkpoint-every",
          "0.001"};
}

std::string dataset_of(const StudyFolder& s, const fs::path& out, int workers, int places) {
  const Ending ending = run_gonogo(campaign_words(s, out, workers, places));
  INFO(ending.err);
  REQUIRE(ending.exit_code == 0);
  return read_file(out / "dataset.h5");
}

std::vector<fs::path> saved_trials(const fs::path& out) {
  std::vector<fs::path> files;
  for (const std::string& file : files_below(campaign::running_folder(out)))
    if (fs::path(file).extension() == ".h5" && file[0] != '.') files.push_back(campaign::running_folder(out) / file);
  return files;
}

std::size_t finished(const fs::path& out) {
  std::error_code ec;
  return fs::exists(out / "campaign.json", ec) ? campaign::campaign_status(out).done : 0;
}

/// Workers of the campaign in this folder.
std::vector<pid_t> workers_of(const fs::path& out) {
  std::vector<pid_t> found;
  for (const auto& entry : fs::directory_iterator("/proc")) {
    std::ifstream in(entry.path() / "cmdline", std::ios::binary);
    const std::string words{std::istreambuf_iterator<char>(in), {}};
    if (contains(words, "worker") && contains(words, campaign::running_folder(out).string()))
      found.push_back(std::stoi(entry.path().filename().string()));
  }
  return found;
}

/// Files of the folder of courses by name, with their content.
std::map<std::string, std::string> courses_of(const fs::path& out) {
  std::map<std::string, std::string> courses;
  for (const std::string& file : files_below(campaign::course_folder(out)))
    courses[file] = read_file(campaign::course_folder(out) / file);
  return courses;
}

std::string last_line(const std::string& text) {
  const auto end = text.find_last_not_of('\n');
  const auto begin = text.rfind('\n', end);
  return text.substr(begin + 1, end - begin);
}

}  // namespace

TEST_CASE("a campaign gives the same dataset bits with 1, 3 and 8 places") {
  const StudyFolder s;
  const std::string expected = dataset_of(s, s.path("one"), 1, 1);
  CHECK(dataset_of(s, s.path("three"), 2, 3) == expected);
  CHECK(dataset_of(s, s.path("eight"), 1, 8) == expected);
  CHECK_FALSE(fs::exists(campaign::running_folder(s.path("three"))));
}

TEST_CASE("a campaign killed with kill -9 goes on from its saved trials to the same dataset bits") {
  const StudyFolder s;
  const std::string expected = dataset_of(s, s.path("undisturbed"), 1, 1);
  const fs::path out = s.out();
  for (const std::size_t done : {0, 1, 3}) {
    RunOptions kill;
    kill.signal = SIGKILL;
    kill.when = [&] { return finished(out) >= done && saved_trials(out).size() >= 2; };
    const Ending killed = run_gonogo(campaign_words(s, out, 1, 3), kill);
    REQUIRE(killed.signal == SIGKILL);
    if (done > 0) CHECK(contains(killed.err, "trials that go on from where they were saved: "));
    CHECK_FALSE(fs::exists(out / "dataset.h5"));
    CHECK(saved_trials(out).size() >= 2);
  }
  CHECK(dataset_of(s, out, 2, 2) == expected);
  CHECK_FALSE(fs::exists(campaign::running_folder(out)));
  check_nothing_half_written(out);
}

TEST_CASE("a campaign writes the course of every trial and keeps its dataset bits") {
  const StudyFolder s;
  const std::string expected = dataset_of(s, s.path("without"), 1, 1);
  const fs::path out = s.out();
  std::vector<std::string> words = campaign_words(s, out, 1, 3);
  words.insert(words.end(), {"--course-every", "0.02"});
  REQUIRE(run_gonogo(words).exit_code == 0);
  CHECK(read_file(out / "dataset.h5") == expected);
  const auto courses = courses_of(out);
  const campaign::Dataset dataset = campaign::read_dataset(out / "dataset.h5");
  REQUIRE(courses.size() == dataset.records.size());
  for (const campaign::TrialRecord& record : dataset.records) {
    const std::string course = courses.at(std::to_string(record.point.index) + ".csv");
    INFO(record.point.index);
    CHECK(course.rfind(campaign::kSampleColumns, 0) == 0);
    double time = 0, x = 0;
    REQUIRE(std::sscanf(last_line(course).c_str(), "%lf,%lf", &time, &x) == 2);
    CHECK_THAT(std::max(0.0, x - 0.05),
               Catch::Matchers::WithinAbs(measure_of(record, "distance"), 2e-5));  // behind the run-in
    CHECK_THAT(time - 0.05, Catch::Matchers::WithinAbs(measure_of(record, "drive_time"), 1e-4));
    const auto lines = std::count(course.begin(), course.end(), '\n');
    CHECK(std::abs(double(lines) - 1 - time / 0.02) <= 1.5);
  }
  words[4] = s.path("killed");
  RunOptions kill;
  kill.signal = SIGKILL;
  kill.when = [&] { return finished(s.path("killed")) >= 1 && saved_trials(s.path("killed")).size() >= 2; };
  REQUIRE(run_gonogo(words, kill).signal == SIGKILL);
  REQUIRE(run_gonogo(words).exit_code == 0);
  CHECK(courses_of(s.path("killed")) == courses);
}

TEST_CASE("a worker killed with kill -9 is replaced, and its trials go on to the same dataset bits") {
  const StudyFolder s;
  const std::string expected = dataset_of(s, s.path("undisturbed"), 1, 1);
  const fs::path out = s.out();
  RunOptions kill;
  kill.signal = SIGCONT;  // to the coordinator: nothing
  kill.when = [&] {
    if (finished(out) < 1 || saved_trials(out).size() < 2) return false;
    const std::vector<pid_t> workers = workers_of(out);
    if (workers.empty()) return false;
    ::kill(workers.front(), SIGKILL);
    return true;
  };
  const Ending ending = run_gonogo(campaign_words(s, out, 1, 3), kill);
  INFO(ending.err);
  CHECK(ending.exit_code == 0);
  CHECK(contains(ending.err, "was killed by signal 9"));
  CHECK(contains(ending.err, "its trials are done again"));
  CHECK(read_file(out / "dataset.h5") == expected);
}

TEST_CASE("a saved trial that is damaged is set aside and computed anew, and it is said") {
  const StudyFolder s;
  const std::string expected = dataset_of(s, s.path("undisturbed"), 1, 1);
  const fs::path out = s.out();
  RunOptions kill;
  kill.signal = SIGKILL;
  kill.when = [&] { return saved_trials(out).size() >= 2; };
  REQUIRE(run_gonogo(campaign_words(s, out, 1, 3), kill).signal == SIGKILL);
  const fs::path victim = saved_trials(out).front();
  std::string image = read_file(victim);
  image[image.size() / 2] = char(image[image.size() / 2] ^ 16);
  write_file_atomically(victim, image);
  const Ending ending = run_gonogo(campaign_words(s, out, 1, 3));
  CHECK(ending.exit_code == 0);
  CHECK(contains(ending.err, "set aside as " + victim.filename().string() + ".damaged and the trial starts anew"));
  CHECK(read_file(out / "dataset.h5") == expected);
  CHECK(fs::exists(victim.string() + ".damaged"));
}

TEST_CASE("a trial replayed from the dataset alone gives its bits, and a dataset that was altered shows") {
  const StudyFolder s;
  dataset_of(s, s.out(), 2, 1);
  const fs::path file = s.path("moved.h5");
  fs::rename(s.out() / "dataset.h5", file);
  for (const char* name : {"study.json", "vehicle.json", "calibration.json"}) fs::remove(s.path(name));
  const Ending same = run_gonogo({"dataset", "replay", file, "--trial", "3"});
  INFO(same.err);
  CHECK(same.exit_code == 0);
  CHECK(contains(same.out, "trial 3: the same bits"));
  check_refusal(run_gonogo({"dataset", "replay", file, "--trial", "731"}), 2, {"trial 731", "6 trials"});

  campaign::Dataset altered = campaign::read_dataset(file);
  altered.records[3].measures[0] += 1e-9;
  campaign::write_dataset(s.path("altered.h5"), altered);
  const Ending differs = run_gonogo({"dataset", "replay", s.path("altered.h5"), "--trial", "3"});
  CHECK(differs.exit_code == 1);
  CHECK(contains(differs.out, campaign::contract().measures[0].name + ": "));
  const Ending diff = run_gonogo({"dataset", "diff", file, s.path("altered.h5")});
  CHECK(diff.exit_code == 1);
  CHECK(contains(diff.out, "trial 3 " + campaign::contract().measures[0].name));
  CHECK(run_gonogo({"dataset", "verify", file}).exit_code == 0);
}

TEST_CASE("devices and places that do not exist are refused before anything is done") {
  StudyFolder s;
  const auto words = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all{"campaign", "run", s.path("study.json"), "--out", s.out()};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  check_refusal(run_gonogo(words({"--device", "tpu"})), 2, {"--device", "tpu"});
  check_refusal(run_gonogo(words({"--places", "0"})), 2, {"--places"});
  s.study["compute"] = Json::parse(R"({"device": "cpu", "places": 5000})", "compute");
  s.write();
  check_refusal(run_gonogo(words({})), 2, {"study.json", "compute.places", "5000"});
  s.study["compute"] = Json::parse(R"({"device": "cpu", "palces": 5})", "compute");
  s.write();
  check_refusal(run_gonogo(words({})), 2, {"study.json", "palces"});
  CHECK(files_below(s.out()).empty());
}

}  // namespace gonogo
