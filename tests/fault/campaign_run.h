// Runs of campaign_program in processes of their own, and looks at what they leave.
#pragma once
#include <fcntl.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <vector>

#include "base/files/file.h"
#include "pipeline/campaign/engine/folder.h"
#include "tests/fault/cheap_campaign.h"
#include "tests/support/catch.h"

namespace gonogo::campaign {

namespace fs = std::filesystem;

inline constexpr int kPoints = 200;  // 220 trials
inline constexpr int kTrials = 220;

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
inline bool is_alive(pid_t process) {
  std::ifstream stat("/proc/" + std::to_string(process) + "/stat");
  std::string pid, name, state;
  return (stat >> pid >> name >> state) && state != "Z";
}

inline std::vector<pid_t> children_of(pid_t parent) {
  std::vector<pid_t> children;
  for (const auto& entry : fs::directory_iterator("/proc")) {
    std::ifstream stat(entry.path() / "stat");
    std::string pid, name, state;
    pid_t ppid = 0;
    if (stat >> pid >> name >> state >> ppid && ppid == parent && state != "Z") children.push_back(std::stoi(pid));
  }
  return children;
}

inline std::string dataset_bytes(const fs::path& folder) { return read_file(folder / "dataset.h5"); }

inline void sleep_ms(int milliseconds) { ::usleep(useconds_t(milliseconds) * 1000); }

inline bool wait_until(const std::function<bool()>& condition) {
  for (int i = 0; i < 5000; ++i) {
    if (condition()) return true;
    sleep_ms(2);
  }
  return false;
}

/// Trials that are on disk by now; none before the campaign has begun.
inline std::size_t finished_trials(const fs::path& folder) {
  std::error_code ec;
  return fs::exists(folder / "campaign.json", ec) ? campaign_status(folder).done : 0;
}

inline std::vector<fs::path> shard_files(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code ec;
  for (const auto& entry : fs::directory_iterator(shard_folder(folder), ec))
    if (entry.path().extension() == ".h5" && entry.path().filename().string()[0] != '.') files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

/// A campaign of 22 trials that was stopped after the 15th, in the journal, and its whole journal.
inline std::string stopped_campaign(const fs::path& place) {
  REQUIRE(Run(place, 20, 1, 0, "crash:15").wait() == 1);
  return read_file(journal_path(place));
}

}  // namespace gonogo::campaign
