#include "pipeline/report/film/video.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/file.h"

namespace gonogo::report {
namespace {

/// Runs a program with what it prints going to `log`; returns its exit code, or -1 when a signal ended it.
int run_program(std::vector<std::string> words, const std::filesystem::path& log) {
  std::vector<char*> pointers;
  for (std::string& w : words) pointers.push_back(w.data());
  pointers.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
  pid_t pid = -1;
  const int error = ::posix_spawnp(&pid, pointers[0], &actions, nullptr, pointers.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) throw DeviceError("cannot start " + words[0] + ": " + std::strerror(error));
  int status = 0;
  while (::waitpid(pid, &status, 0) < 0)
    if (errno != EINTR) throw DeviceError("cannot wait for " + words[0] + ": " + std::strerror(errno));
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

std::string last_line(const std::filesystem::path& log) {
  std::istringstream in(std::filesystem::exists(log) ? read_file(log) : "");
  std::string line, last;
  while (std::getline(in, line))
    if (!line.empty()) last = line;
  return last;
}

std::string number(double x) {
  char text[32];
  std::snprintf(text, sizeof text, "%.6g", x);
  return text;
}

}  // namespace

void require_ffmpeg() {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');)
    if (::access((std::filesystem::path(folder) / "ffmpeg").c_str(), X_OK) == 0) return;
  throw InputError(
      "--video needs the program ffmpeg, which is not on the PATH; install it (apt-get install ffmpeg) or take "
      "--frames");
}

void make_video(const std::filesystem::path& folder, int count, double rate, const std::filesystem::path& video) {
  const auto log = folder / "ffmpeg.log";
  replace_file_atomically(video, [&](const std::filesystem::path& temporary) {
    const int code = run_program({"ffmpeg",
                                  "-nostdin",
                                  "-y",
                                  "-loglevel",
                                  "error",
                                  "-framerate",
                                  number(rate),
                                  "-i",
                                  (folder / "frame_%06d.png").string(),
                                  "-frames:v",
                                  std::to_string(count),
                                  "-c:v",
                                  "libx264",
                                  "-crf",
                                  "18",
                                  "-pix_fmt",
                                  "yuv420p",
                                  "-movflags",
                                  "+faststart",
                                  std::filesystem::absolute(temporary).string()},
                                 log);
    if (code != 0) throw DeviceError(video.string() + ": ffmpeg failed: " + last_line(log));
  });
  std::filesystem::remove(log);
}

}  // namespace gonogo::report
