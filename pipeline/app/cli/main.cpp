// gonogo: where can this vehicle go, how sure are we, and why not?
#include <omp.h>

#include <algorithm>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <new>
#include <string>
#include <vector>

#include "base/cancel.h"
#include "base/error.h"
#include "base/nearest.h"
#include "base/version.h"
#include "pipeline/app/cli/command.h"

namespace gonogo::app {
namespace {

constexpr int kMaxThreads = 4096;

std::string version_text() { return std::string("gonogo ") + program_version() + " (" + program_revision() + ")"; }

void add_globals(CLI::App& app, Globals& globals) {
  app.set_version_flag("--version", version_text());
  app.add_flag("--json", globals.json, "Machine-readable result: one JSON object as the last line of stdout");
  app.add_option("--threads", globals.threads, "Threads to use; 0 takes all cores. Results do not depend on it")
      ->check(CLI::Range(0, kMaxThreads))
      ->each([](const std::string& count) {
        if (const int threads = std::stoi(count); threads > 0) omp_set_num_threads(threads);
      });
}

void describe(CLI::App& app) {
  app.name("gonogo");
  app.description(
      "Go/NoGo mobility maps for off-road vehicles: where can this vehicle go, how sure are we, and why not?");
  app.footer(
      "Example:\n  gonogo run configs/studies/demo.json --out out/demo\n\n"
      "gonogo <command> --help explains a command and shows an example.\n"
      "Exit status: 0 success, 1 device or program failure, 2 bad input, 130 interrupted.");
  app.fallthrough();  // inherited by commands: options of the program may stand before or after the command
}

/// One sentence for a line that does not parse; the nearest command or option when a word is unknown.
std::string explain(const CLI::App& app, const CLI::ParseError& error, const std::vector<std::string>& words) {
  std::vector<std::string> commands;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; }))
    commands.push_back(command->get_name());
  const auto chosen = app.get_subcommands();
  const std::string help = "gonogo " + (chosen.empty() ? "" : chosen.front()->get_name() + " ") + "--help";
  if (words.empty()) return "no command given; one of: " + join_words(commands) + "; see " + help;
  if (chosen.empty()) {
    const auto word = std::find_if(words.begin(), words.end(), [](const auto& w) { return w.substr(0, 1) != "-"; });
    if (word != words.end() && std::find(commands.begin(), commands.end(), *word) == commands.end())
      return "\"" + *word + "\" is no command; did you mean \"" + nearest_word(*word, commands) +
             "\"? Commands: " + join_words(commands);
  }
  std::string message = error.what();
  std::replace(message.begin(), message.end(), '\n', ' ');
  return message + "; see " + help;
}

int fail(ExitCode code, const std::string& sentence) {
  std::fprintf(stderr, "gonogo: %s\n", sentence.c_str());
  return int(code);
}

int run(int argc, char** argv) {
  Globals globals;
  CLI::App app;
  describe(app);
  add_globals(app, globals);
  add_commands(app, globals);
  app.require_subcommand(1);
  const std::vector<std::string> words(argv + 1, argv + argc);
  try {
    app.parse(std::vector<std::string>(words.rbegin(), words.rend()));  // CLI11 takes the words last first
    return int(ExitCode::success);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == int(CLI::ExitCodes::Success)) return app.exit(error);  // --help, --version
    return fail(ExitCode::bad_input, explain(app, error, words));
  }
}

/// Every way out of the program is an exit code and at most one sentence.
int run_and_explain(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const InputError& error) {
    return fail(ExitCode::bad_input, error.what());
  } catch (const Cancelled& error) {
    return fail(ExitCode::interrupted, error.what());
  } catch (const DeviceError& error) {
    return fail(ExitCode::failure, error.what());
  } catch (const std::filesystem::filesystem_error& error) {
    return fail(ExitCode::failure, error.path1().string() + ": " + error.code().message());
  } catch (const std::bad_alloc&) {
    return fail(ExitCode::failure, "out of memory; take a smaller problem or a machine with more memory");
  } catch (const std::exception& error) {
    return fail(ExitCode::failure, std::string("unexpected failure: ") + error.what());
  } catch (...) {
    return fail(ExitCode::failure, "unexpected failure of unknown kind");
  }
}

}  // namespace
}  // namespace gonogo::app

int main(int argc, char** argv) {
  gonogo::install_cancel_handler();
  return gonogo::app::run_and_explain(argc, argv);
}
