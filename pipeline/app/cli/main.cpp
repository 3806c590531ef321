// gonogo: where can this vehicle go, how sure are we, and why not?
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <new>

#include "base/progress.h"
#include "pipeline/app/cli/complete.h"
#include "pipeline/app/cli/program.h"

namespace gonogo::app {
namespace {

int fail(const Globals& globals, ExitCode code, const std::string& sentence, const InputPlace& place = {}) {
  std::fprintf(stderr, "gonogo: %s\n", sentence.c_str());
  if (globals.json && !result_printed()) {
    Json json = Json::object();
    json["error"] = error_json(code, sentence, place);
    std::printf("%s\n", json.dump().c_str());
    std::fflush(stdout);
  }
  return int(code);
}

int parse(CLI::App& program, Globals& globals, const std::vector<std::string>& words) {
  try {
    program.parse(std::vector<std::string>(words.rbegin(), words.rend()));  // CLI11 takes the words last first
    return int(ExitCode::success);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == int(CLI::ExitCodes::Success)) return program.exit(error);  // --help, --version
    globals.json = asks_for_json(words);
    return fail(globals, ExitCode::bad_input, explain(program, error, words));
  }
}

int run(Globals& globals) {
  const std::unique_ptr<Program> program = make_program(globals);
  std::vector<std::string> words(globals.command_line.begin() + 1, globals.command_line.end());
  // Two questions of scripts, which no command answers because the words after the dashes are not the program's own:
  // what completes the last word, and whether a line parses.
  if (words.size() < 2 || words[1] != "--") return parse(*program, globals, words);
  const std::string question = words.front();
  const std::vector<std::string> line(words.begin() + 2, words.end());
  if (question == "complete") {
    std::fputs(completions(*program, line).c_str(), stdout);
    return int(ExitCode::success);
  }
  if (question != "parse") return parse(*program, globals, words);
  program->parse_only = true;
  return parse(*program, globals, line);
}

/// Every way out of the program is an exit code and at most one sentence.
int run_and_explain(Globals& globals) {
  try {
    return run(globals);
  } catch (const PlacedInputError& error) {
    return fail(globals, ExitCode::bad_input, error.what(), error.place);
  } catch (const InputError& error) {
    return fail(globals, ExitCode::bad_input, error.what());
  } catch (const Cancelled& error) {
    return fail(globals, ExitCode::interrupted, error.what());
  } catch (const DeviceError& error) {
    return fail(globals, ExitCode::failure, error.what());
  } catch (const std::filesystem::filesystem_error& error) {
    return fail(globals, ExitCode::failure, error.path1().string() + ": " + error.code().message());
  } catch (const std::bad_alloc&) {
    return fail(globals, ExitCode::failure, "out of memory; take a smaller problem or a machine with more memory");
  } catch (const std::exception& error) {
    return fail(globals, ExitCode::failure, std::string("unexpected failure: ") + error.what());
  } catch (...) {
    return fail(globals, ExitCode::failure, "unexpected failure of unknown kind");
  }
}

/// A thread that waits for the others of its team spins 300,000 turns before it sleeps (GOMP_SPINCOUNT of libgomp).
/// Where other programs run, these turns cost many times the work. Libgomp reads its environment when it is loaded, so
/// the program replaces itself once; where that fails it goes on as it is.
void let_threads_sleep(char** argv) {
  if (std::getenv("OMP_WAIT_POLICY") != nullptr || std::getenv("GOMP_SPINCOUNT") != nullptr) return;
  std::error_code failed;
  const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", failed);
  if (failed || setenv("GOMP_SPINCOUNT", "1000", 1) != 0) return;
  execv(self.c_str(), argv);
}

}  // namespace
}  // namespace gonogo::app

int main(int argc, char** argv) {
  gonogo::app::let_threads_sleep(argv);
  gonogo::install_cancel_handler();
  gonogo::app::Globals globals;
  globals.command_line.assign(argv, argv + argc);
  return gonogo::app::run_and_explain(globals);
}
