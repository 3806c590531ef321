#include "pipeline/app/cli/program.h"

#include <omp.h>

#include <algorithm>

#include "base/files/file.h"
#include "base/format.h"
#include "base/version.h"
#include "pipeline/app/cli/table.h"
#include "pipeline/app/cli/work.h"

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
  program.add_flag_callback("--allow-network", &allow_network,
                            "Open also files that name hosts, databases or bytes of other files: VRT, WMS, ...");
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

/// In the place of a command whose room was left out of this build: takes any words and options, and says so.
void add_left_out(CLI::App& program, Globals& globals, const CommandEntry& entry) {
  CLI::App* command =
      program.add_subcommand(entry.name, std::string("Left out of this build (") + entry.left_out + "=OFF)");
  command->fallthrough(false)->allow_extras();
  add_examples(*command, {"gonogo doctor  # what is part of this build"});
  command->callback([command, &globals] {
    globals.json = globals.json || asks_for_json(command->remaining());
    do_elsewhere(*command, globals);
  });
}

}  // namespace

std::unique_ptr<Program> make_program(Globals& globals) {
  auto program = std::make_unique<Program>();
  describe(*program);
  add_globals(*program, globals);
  for (const CommandEntry& entry : all_commands())
    entry.add != nullptr ? entry.add(*program, globals) : add_left_out(*program, globals, entry);
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

namespace {

/// The deepest command that the line names; the program itself when it names none.
const CLI::App& chosen(const CLI::App& program) {
  const std::vector<CLI::App*> below = program.get_subcommands();
  return below.empty() ? program : chosen(*below.back());
}

std::string quoted(const std::string& word) { return "\"" + word + "\""; }

/// " (did you mean "--threads"?)" where a name is near: at most half of its letters differ, or their order.
std::string did_you_mean(const std::string& word, const std::vector<std::string>& names) {
  const std::string nearest = nearest_word(word, names);
  const bool reordered = std::is_permutation(word.begin(), word.end(), nearest.begin(), nearest.end());
  if (nearest.empty() || (!reordered && 2 * edit_distance(word, nearest) > std::max(word.size(), nearest.size())))
    return "";
  return " (did you mean " + quoted(nearest) + "?)";
}

std::string unknown_option(const CLI::App& command, const std::string& word) {
  std::vector<std::string> names{"--help"};
  for (const CLI::App* at = &command; at != nullptr; at = at->get_parent())
    for (const CLI::Option* option : options_of(*at))
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  const std::string name = word.substr(0, word.find('='));
  return quoted(name) + " is no option of " + full_name(command) + did_you_mean(name, names);
}

std::string unknown_command(const CLI::App& command, const std::string& word) {
  const std::vector<std::string> names = names_of(commands_of(command));
  const std::string where = command.get_parent() ? "no command of " + full_name(command) : "no command";
  return quoted(word) + " is " + where + did_you_mean(word, names) + "; commands: " + join_words(names);
}

std::string about_word(const CLI::App& command, const std::string& word) {
  if (word.size() > 1 && word[0] == '-') return unknown_option(command, word);
  if (!commands_of(command).empty()) return unknown_command(command, word);
  return quoted(word) + " is one word more than " + full_name(command) + " takes";
}

/// Whether the line lacks something or has too much. With an unknown word in it, that word is the likelier fault.
bool lacks_or_exceeds(const CLI::ParseError& error) {
  const auto code = CLI::ExitCodes(error.get_exit_code());
  return code == CLI::ExitCodes::ExtrasError || code == CLI::ExitCodes::RequiredError;
}

}  // namespace

std::string explain(const CLI::App& program, const CLI::ParseError& error, const std::vector<std::string>& words) {
  const CLI::App& command = chosen(program);
  const std::string see = "; see " + full_name(command) + " --help";
  const std::vector<std::string> extras = program.remaining(true);
  const bool unknown_option_first = !extras.empty() && extras.front().size() > 1 && extras.front()[0] == '-';
  if ((lacks_or_exceeds(error) && !extras.empty()) || unknown_option_first)
    return about_word(command, extras.front()) + see;
  if (lacks_or_exceeds(error) && !commands_of(command).empty()) {
    const std::string what = words.empty() ? "no command given" : full_name(command) + " needs a command";
    return what + "; one of: " + join_words(names_of(commands_of(command))) + see;
  }
  std::string message = error.what();
  std::replace(message.begin(), message.end(), '\n', ' ');
  return message + see;
}

}  // namespace gonogo::app
