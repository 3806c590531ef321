#include "tests/fault/program.h"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <thread>

#include "base/files/file.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"

namespace gonogo {
namespace fs = std::filesystem;
namespace {

const std::string kProgramName = "gonogo: ";
constexpr uid_t kNobody = 65534;
constexpr auto kPatience = std::chrono::minutes(5);

[[noreturn]] void become_gonogo(const std::vector<std::string>& words, const RunOptions& options, const fs::path& out,
                                const fs::path& err) {
  if (!std::freopen(out.c_str(), "w", stdout) || !std::freopen(err.c_str(), "w", stderr)) ::_exit(99);
  std::vector<char*> argv{const_cast<char*>(GONOGO_PROGRAM)};
  for (const auto& word : words) argv.push_back(const_cast<char*>(word.c_str()));
  argv.push_back(nullptr);
  if (options.before) options.before();
  ::execv(GONOGO_PROGRAM, argv.data());
  ::_exit(99);
}

/// Waits for the child; signals it once when the moment has come, kills it when patience is over.
int wait_for(pid_t child, const RunOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  bool signalled = options.signal == 0;
  int status = 0;
  while (::waitpid(child, &status, WNOHANG) == 0) {
    if (!signalled && options.when()) {
      ::kill(child, options.signal);
      signalled = true;
    }
    if (std::chrono::steady_clock::now() - start > kPatience) {
      ::kill(child, SIGKILL);
      ::waitpid(child, &status, 0);
      FAIL("the program did not end");
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return status;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::size_t start = 0;
  while (start < text.size()) {
    const std::size_t end = std::min(text.find('\n', start), text.size());
    lines.push_back(text.substr(start, end - start));
    start = end + 1;
  }
  return lines;
}

}  // namespace

Ending run_gonogo(const std::vector<std::string>& words, const RunOptions& options) {
  const TemporaryFolder folder;
  const pid_t child = ::fork();
  if (child == 0) become_gonogo(words, options, folder / "out", folder / "err");
  const int status = wait_for(child, options);
  Ending ending{.exit_code = -1, .signal = 0, .out = read_file(folder / "out"), .err = read_file(folder / "err")};
  if (WIFEXITED(status)) ending.exit_code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) ending.signal = WTERMSIG(status);
  return ending;
}

namespace {

/// Checks the exit code and the one sentence on stderr; returns the sentence without the program's name.
std::string check_sentence(const Ending& ending, int exit_code, const std::vector<std::string>& parts) {
  INFO("stderr: " << ending.err);
  CHECK(ending.exit_code == exit_code);
  const auto lines = lines_of(ending.err);
  REQUIRE_FALSE(lines.empty());
  const auto is_sentence = [](const std::string& line) { return line.rfind(kProgramName, 0) == 0; };
  CHECK(is_sentence(lines.back()));
  CHECK(std::count_if(lines.begin(), lines.end(), is_sentence) == 1);
  CHECK_FALSE(contains(lines.back(), "unexpected failure"));
  for (const auto& part : parts) {
    INFO("expected part: " << part);
    CHECK(contains(lines.back(), part));
  }
  return lines.back().substr(std::min(kProgramName.size(), lines.back().size()));
}

}  // namespace

void check_refusal(const Ending& ending, int exit_code, const std::vector<std::string>& parts) {
  CHECK(ending.out == "");
  check_sentence(ending, exit_code, parts);
}

Json check_json_refusal(const Ending& ending, int exit_code, const std::string& kind,
                        const std::vector<std::string>& parts) {
  const std::string sentence = check_sentence(ending, exit_code, parts);
  const auto lines = lines_of(ending.out);
  REQUIRE_FALSE(lines.empty());
  Json error = Json::parse(lines.back(), "stdout").at("error");
  CHECK(error.at("kind").string() == kind);
  CHECK(error.at("message").string() == sentence);
  return error;
}

fs::path gonogo_program() { return GONOGO_PROGRAM; }

std::vector<std::string> files_below(const fs::path& folder) {
  std::vector<std::string> files;
  if (!fs::exists(folder)) return files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (!entry.is_directory()) files.push_back(entry.path().lexically_relative(folder).string());
  std::sort(files.begin(), files.end());
  return files;
}

void check_nothing_half_written(const fs::path& folder) {
  for (const auto& file : files_below(folder)) {
    INFO(file);
    CHECK_FALSE(contains(file, ".partial-"));
  }
}

void become_ordinary_user() {
  if (::geteuid() == 0 && ::setuid(kNobody) != 0) ::_exit(99);
}

void limit_file_size(std::size_t bytes) {
  std::signal(SIGXFSZ, SIG_IGN);  // stays ignored in the program: the write fails instead of ending it
  const rlimit limit{bytes, bytes};
  if (::setrlimit(RLIMIT_FSIZE, &limit) != 0) ::_exit(99);
}

}  // namespace gonogo
