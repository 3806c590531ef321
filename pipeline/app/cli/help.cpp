#include <memory>

#include "base/nearest.h"
#include "pipeline/app/cli/command.h"
#include "pipeline/app/cli/table.h"

namespace gonogo::app {
namespace {

/// The command that the words name from the program down. Throws InputError.
const CLI::App& command_at(const CLI::App& program, const std::vector<std::string>& words) {
  const CLI::App* at = &program;
  for (const std::string& word : words) {
    const CLI::App* below = command_named(*at, word);
    if (below == nullptr) {
      const std::vector<std::string> names = names_of(commands_of(*at));
      const std::string what = "help: \"" + word + "\" is no command of " + full_name(*at);
      if (names.empty()) throw InputError(what + ", which has none");
      throw InputError(what + " (did you mean \"" + nearest_word(word, names) + "\"?); commands: " + join_words(names));
    }
    at = below;
  }
  return *at;
}

}  // namespace

void add_help_command(CLI::App& app, const Globals& globals) {
  CLI::App* command = app.add_subcommand("help", "Explain a command: its options and examples");
  const auto words = std::make_shared<std::vector<std::string>>();
  command->add_option("command", *words, "Command, and the one below it")->type_name(kCommand);
  add_examples(*command, {"gonogo help", "gonogo help train", "gonogo help soil test shear"});
  command->callback([words, &app, &globals] {
    const std::string text = help_of(command_at(app, *words));
    Json result = Json::object();
    result["help"] = text;
    print_result(globals, result, text);
  });
}

}  // namespace gonogo::app
