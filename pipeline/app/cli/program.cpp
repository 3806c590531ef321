#include "pipeline/app/cli/program.h"

#include <omp.h>

#include "base/version.h"
#include "pipeline/app/cli/table.h"

namespace gonogo::app {
namespace {

constexpr int kMaxThreads = 4096;

std::string version_text() { return std::string("gonogo ") + program_version() + " (" + program_revision() + ")"; }

void add_globals(CLI::App& program, Globals& globals) {
  program.set_version_flag("--version", version_text(), "Print version and revision");
  program.add_flag("--json", globals.json, "Machine-readable result: one JSON object as the last line of stdout");
  program.add_option("--threads", globals.threads, "Threads to use; 0 takes all cores. Results do not depend on it")
      ->capture_default_str()
      ->check(CLI::Range(0, kMaxThreads))
      ->each([](const std::string& count) {
        if (const int threads = std::stoi(count); threads > 0) omp_set_num_threads(threads);
      });
}

void describe(CLI::App& program) {
  program.name("gonogo");
  program.description(
      "Go/NoGo mobility maps for off-road vehicles: where can this vehicle go, how sure are we, and why not?");
  add_examples(program, {"gonogo run configs/studies/demo.json --out out/demo"},
               "gonogo help <command> explains a command and shows an example.\n"
               "Exit status: 0 success, 1 device or program failure, 2 bad input, 130 interrupted.");
  program.fallthrough();  // inherited by commands: options of the program may stand before or after the command
  program.formatter(std::make_shared<HelpFormat>());
  program.set_help_flag("-h,--help", "Print this help");
}

}  // namespace

std::unique_ptr<Program> make_program(Globals& globals) {
  auto program = std::make_unique<Program>();
  describe(*program);
  add_globals(*program, globals);
  add_commands(*program, globals);
  program->require_subcommand(1);
  return program;
}

bool asks_for_json(const std::vector<std::string>& words) {
  for (const std::string& word : words) {
    if (word == "--json") return true;
    if (word == "--") break;
  }
  return false;
}

}  // namespace gonogo::app
