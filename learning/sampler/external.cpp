#include "learning/sampler/external.h"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>
#include <chrono>
#include <cstring>

#include "base/error.h"
#include "base/files/file.h"
#include "base/format.h"
#include "base/progress.h"
#include "learning/formats/dimod.h"
#include "learning/formats/format.h"
#include "learning/sampler/sampler.h"

namespace gonogo::learning {
namespace {

namespace fs = std::filesystem;

void write_with_sidecar(const Problem& problem, const fs::path& path) {
  const Format& format = format_named("dimod_json");
  const WrittenProblem written = write_problem(problem, format);
  write_file_atomically(sidecar_path(path), to_json(sidecar_of(written, format)).dump(1) + "\n");
  write_file_atomically(path, written.text);
}

/// One row per read instead of counts. Throws InputError unless there are `reads` rows. Messages begin with `source`.
SampleSet spread_reads(const SampleSet& answer, std::size_t reads, const std::string& source) {
  std::int64_t count = 0;
  for (std::int64_t occurrences : answer.occurrences) {
    count += occurrences;
    if (count > std::int64_t(reads)) break;
  }
  if (count != std::int64_t(reads))
    throw InputError(source + ": holds " +
                     (count > std::int64_t(reads) ? "more than " : std::to_string(count) + " of ") +
                     std::to_string(reads) + " reads that were asked for");
  SampleSet rows = answer;
  rows.values.clear();
  rows.energies.clear();
  rows.occurrences.assign(reads, 1);
  for (std::size_t r = 0; r < answer.row_count(); ++r)
    for (std::int64_t k = 0; k < answer.occurrences[r]; ++k) {
      rows.values.insert(rows.values.end(), answer.row(r).begin(), answer.row(r).end());
      rows.energies.push_back(answer.energies[r]);
    }
  return rows;
}

SampleSet rows_of_answer(const Problem& problem, const fs::path& path, std::size_t reads) {
  const SampleSet answer = samples_from_dimod_json(read_file(path), path.string());
  return spread_reads(check_answer(problem, answer, path.string()), reads, path.string());
}

/// A folder that goes with everything in it.
struct Scratch {
  fs::path path;
  Scratch() {
    std::string name = (fs::temp_directory_path() / "gonogo-command-XXXXXX").string();
    if (!::mkdtemp(name.data())) throw DeviceError(name + ": cannot make a temporary folder");
    path = name;
  }
  ~Scratch() {
    std::error_code ignored;
    fs::remove_all(path, ignored);
  }
};

std::string filled(std::string argument, const std::vector<std::pair<std::string, std::string>>& values) {
  for (const auto& [key, value] : values)
    for (std::size_t at = argument.find(key); at != std::string::npos; at = argument.find(key, at + value.size()))
      argument.replace(at, key.size(), value);
  return argument;
}

[[noreturn]] void fail(const std::vector<std::string>& command, const std::string& what, const ProcessResult& result) {
  const std::string text =
      result.error_text.empty() ? "; it wrote nothing to stderr" : "; its stderr ends:\n" + result.error_text;
  throw InputError("command \"" + command[0] + "\" " + what + text);
}

/// Writes problems to <folder>/<hash>.json (dimod's JSON, with a sidecar) and reads answers from
/// <folder>/<hash>.answer.json (dimod's SampleSet). When the answer is missing, InputError names it; the same command
/// continues once the file exists. The hash covers seed and number of reads, so that each request has its own file.
SampleSet sample_by_file(const Problem& problem, const SampleRequest& request, const SamplerSettings& settings) {
  const fs::path folder = setting<std::string>(settings, "folder");
  const std::string hash = content_hash(problem_hash(problem) + " " + std::to_string(request.reads) + " " +
                                        std::to_string(request.seed) + " " + std::to_string(request.first_sweep));
  const fs::path file = folder / (hash + ".json"), answer = folder / (hash + ".answer.json");
  if (fs::exists(answer)) return rows_of_answer(problem, answer, request.reads);
  write_with_sidecar(problem, file);
  throw InputError("sampler file: " + file.string() + " waits for " + std::to_string(request.reads) +
                   " reads; put them into " + answer.string() + " (dimod's SampleSet) and give the same command again");
}

/// Runs a program that reads {problem} (dimod's JSON) and writes {answer} (dimod's SampleSet). It must exit with status
/// 0 within the time limit, and give the requested number of reads. Otherwise throws InputError with the end of its
/// stderr.
SampleSet sample_by_command(const Problem& problem, const SampleRequest& request, const SamplerSettings& settings) {
  const auto time_limit_s = setting<double>(settings, "time_limit_s");
  const Scratch scratch;
  const fs::path file = scratch.path / "problem.json", answer = scratch.path / "answer.json";
  write_with_sidecar(problem, file);
  std::vector<std::string> arguments;
  for (const std::string& argument : setting<std::vector<std::string>>(settings, "program"))
    arguments.push_back(filled(argument, {{"{problem}", file.string()},
                                          {"{answer}", answer.string()},
                                          {"{reads}", std::to_string(request.reads)},
                                          {"{seed}", std::to_string(request.seed)}}));
  const ProcessResult result = run_process(arguments, time_limit_s);
  if (result.timed_out)
    fail(arguments, "did not end within " + number_text(time_limit_s) + " s and was killed", result);
  if (result.signal != 0) fail(arguments, "was ended by signal " + std::to_string(result.signal), result);
  if (result.exit_status != 0) fail(arguments, "failed with exit status " + std::to_string(result.exit_status), result);
  if (!fs::exists(answer)) fail(arguments, "ended well but wrote no answer", result);
  return rows_of_answer(problem, answer, request.reads);
}

}  // namespace

extern const SamplerKind kFile = {
    .name = "file",
    .title = "File",
    .about = "Rows that a person puts into a folder.",
    .parameters = {{"folder", "--folder", "where problems are put and answers are found", std::string()}},
    .origin = RowOrigin::person,
    .sample = sample_by_file};

extern const SamplerKind kCommand = {
    .name = "command",
    .title = "Command",
    .about = "Rows of another program.",
    .parameters = {{"program", "program",
                    "after --, program and arguments, no shell; {problem}, {answer}, {reads}, {seed} are filled in",
                    std::vector<std::string>()},
                   {.name = "time_limit_s",
                    .option = "--time-limit",
                    .help = "seconds",
                    .fallback = 600.0,
                    .lowest = 0,
                    .above_lowest = true}},
    .origin = RowOrigin::program,
    .sample = sample_by_command};

namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kKeptText = 4000;

struct Pipe {
  int read = -1, write = -1;
  Pipe() {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) throw DeviceError(std::string("pipe: ") + std::strerror(errno));
    read = ends[0];
    write = ends[1];
  }
  ~Pipe() {
    ::close(read);
    if (write >= 0) ::close(write);
  }
};

pid_t start(const std::vector<std::string>& arguments, const Pipe& error) {
  std::vector<char*> list;
  for (const std::string& argument : arguments) list.push_back(const_cast<char*>(argument.c_str()));
  list.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
  posix_spawn_file_actions_init(&actions);
  posix_spawnattr_init(&attributes);
  posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_adddup2(&actions, error.write, STDERR_FILENO);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);  // a group of its own, so that its children end with it
  posix_spawnattr_setpgroup(&attributes, 0);
  pid_t pid = 0;
  const int status = ::posix_spawnp(&pid, list[0], &actions, &attributes, list.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  if (status != 0) throw InputError("command \"" + arguments[0] + "\" cannot be started: " + std::strerror(status));
  return pid;
}

void keep_tail(std::string& text, const char* bytes, std::size_t count) {
  text.append(bytes, count);
  if (text.size() > kKeptText) text.erase(0, text.size() - kKeptText);
}

/// Reads what is there now, waiting at most 50 ms.
void read_some(int pipe, std::string& text) {
  pollfd poll{pipe, POLLIN, 0};
  if (::poll(&poll, 1, 50) <= 0) return;
  char bytes[4096];
  const ssize_t count = ::read(pipe, bytes, sizeof bytes);
  if (count > 0)
    keep_tail(text, bytes, std::size_t(count));
  else
    ::usleep(10'000);  // the program has closed its stderr and runs on
}

}  // namespace

ProcessResult run_process(const std::vector<std::string>& arguments, double time_limit_s) {
  if (arguments.empty() || arguments[0].empty()) throw InputError("command: no program is given");
  Pipe error;
  const pid_t pid = start(arguments, error);
  ::close(error.write);
  error.write = -1;
  const auto begin = Clock::now();
  ProcessResult result;
  bool cancelled = false;
  int status = 0;
  while (::waitpid(pid, &status, WNOHANG) == 0) {
    read_some(error.read, result.error_text);
    cancelled = cancelled || cancel_requested();
    result.timed_out = std::chrono::duration<double>(Clock::now() - begin).count() > time_limit_s;
    if (!cancelled && !result.timed_out) continue;
    ::kill(-pid, SIGKILL);
    ::waitpid(pid, &status, 0);
    break;
  }
  ::kill(-pid, SIGKILL);  // what it may have left behind
  char bytes[4096];
  ::fcntl(error.read, F_SETFL, O_NONBLOCK);
  for (ssize_t count; (count = ::read(error.read, bytes, sizeof bytes)) > 0;)
    keep_tail(result.error_text, bytes, std::size_t(count));
  if (cancelled) stop_if_cancelled();
  if (WIFEXITED(status)) result.exit_status = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) result.signal = WTERMSIG(status);
  return result;
}

}  // namespace gonogo::learning
