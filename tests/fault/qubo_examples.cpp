// The documented examples of gonogo qubo, run as they are written, on the model that ships for them.
#include <cmath>
#include <cstdio>
#include <sstream>

#include "base/files/file.h"
#include "tests/fault/program.h"
#include "tests/fault/shell.h"
#include "tests/support/catch.h"
#include "tests/support/message.h"
#include "tests/support/temporary_folder.h"

namespace gonogo {
namespace {

namespace fs = std::filesystem;

/// A folder with the source tree's tests/, for the problems in it.
const fs::path& working_folder() {
  static const TemporaryFolder folder;
  static const fs::path path = [] {
    fs::create_directory_symlink(GONOGO_SOURCE_DIR "/tests", folder.path() / "tests");
    return folder.path();
  }();
  return path;
}

/// Lines that begin with "gonogo qubo", with their continuations, in the order of the text.
std::vector<std::string> examples_in(const std::string& text) {
  std::vector<std::string> result;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t at = line.find_first_not_of(' ');
    if (at == std::string::npos || line.compare(at, 12, "gonogo qubo ") != 0) continue;
    result.push_back(line.substr(at));
    while (result.back().back() == '\\' && std::getline(lines, line)) {
      result.back().pop_back();
      result.back() += line;
    }
  }
  return result;
}

struct Counts {
  std::size_t run = 0, answers = 0;
};

/// Runs the examples, and holds every answer that is imported against the machine's own probabilities.
Counts run_examples(const std::vector<std::string>& examples) {
  Counts counts;
  for (std::string line : examples) {
    INFO(line);
    if (contains(line, "ocean_bridge") || contains(line, "--gpu")) continue;  // need what is not part of the program
    const bool answer = contains(line, "qubo import");
    const std::string program = gonogo_program().string() + line.substr(6) + (answer ? " --json" : "");
    const ShellEnding ending = shell("cd " + working_folder().string() + " && " + program + " 2>/dev/null");
    REQUIRE(ending.status == 0);
    ++counts.run;
    if (!answer) continue;
    const Json report = Json::parse(ending.output, "import");
    if (!report.find("outcomes")) continue;
    ++counts.answers;
    CHECK(report.at("bias").at("verdict").string() == "none found");
    for (const char* outcome : {"go", "no_go/traction"}) {
      const Json& entry = report.at("outcomes").at(outcome);
      std::printf("%s: %s %.4f +- %.4f, machine's own %.4f\n", line.c_str(), outcome, entry.at("frequency").number(),
                  entry.at("standard_error").number(), entry.at("machine").number());
      // Of ten answers one lies beyond two standard errors by chance in four of ten sets, beyond three in one of forty.
      CHECK(std::abs(entry.at("difference_in_errors").number()) <= 3);
    }
  }
  return counts;
}

TEST_CASE("the example in the README gives the machine's own answer") {
  const Counts counts = run_examples(examples_in(read_file(GONOGO_SOURCE_DIR "/README.md")));
  CHECK(counts.run == 3);
  CHECK(counts.answers == 1);
}

TEST_CASE("the examples of gonogo qubo --help give the machine's own answer") {
  const Counts counts = run_examples(examples_in(run_gonogo({"qubo", "--help"}).out));
  CHECK(counts.run == 3);
  CHECK(counts.answers == 1);
}

TEST_CASE("the examples on the page of annealers give the machine's own answer") {
  const Counts counts = run_examples(examples_in(read_file(GONOGO_SOURCE_DIR "/docs/annealer.md")));
  CHECK(counts.run >= 7);
  CHECK(counts.answers == 3);
}

}  // namespace
}  // namespace gonogo
