// The tables of commands, read back from CLI11 for help, man page, completions and the explanation of bad lines.
#pragma once
#include <string>
#include <vector>

#include "pipeline/app/cli/command.h"

namespace gonogo::app {

/// What an option or positional takes.
struct Value {
  std::string name;                  // "FILE", "INT", "{cpu,cuda}"; empty: nothing, a flag
  std::vector<std::string> choices;  // of a name in braces
  std::string limits;                // "1 to 100"; empty: none
  std::string initial;               // what holds when it is not given; empty: nothing, or not known
  bool many = false;
};

Value value_of(const CLI::Option& option);

/// "(1 to 100; default 2)" after a blank; empty where there is nothing to say.
std::string remarks(const CLI::Option& option);

/// Options of a command but --help, in order, its option groups' too. Hidden ones are left out.
std::vector<const CLI::Option*> options_of(const CLI::App& command);
std::vector<const CLI::Option*> positionals_of(const CLI::App& command);
/// Option of a command or of one above it, by its name with dashes; null where there is none.
const CLI::Option* option_named(const CLI::App& command, const std::string& name);

/// Commands below a command, in order. Hidden ones are left out.
std::vector<const CLI::App*> commands_of(const CLI::App& command);
/// Null where there is none.
const CLI::App* command_named(const CLI::App& command, const std::string& name);
std::vector<std::string> names_of(const std::vector<const CLI::App*>& commands);

/// "gonogo soil test"
std::string full_name(const CLI::App& command);

/// The help of a command, as --help prints it.
std::string help_of(const CLI::App& command);

/// Formats the help of all commands.
class HelpFormat : public CLI::Formatter {
 public:
  std::string make_option_opts(const CLI::Option* option) const override;
  std::string make_option_desc(const CLI::Option* option) const override;
  std::string make_description(const CLI::App* command) const override;
  std::string make_subcommand(const CLI::App* command) const override;
};

}  // namespace gonogo::app
