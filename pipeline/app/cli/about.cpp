// What the program says of itself: help, completions, and the man page made from the tables of commands.
#include <cctype>
#include <memory>

#include "base/format.h"
#include "base/version.h"
#include "pipeline/app/cli/command.h"
#include "pipeline/app/cli/complete.h"
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
  add_named(*command, "command", *words, kCommand, "Command, and the one below it");
  add_examples(*command, {"gonogo help", "gonogo help train", "gonogo help soil test shear"});
  command->callback([words, &app, &globals] {
    const std::string text = help_of(command_at(app, *words));
    Json result = Json::object();
    result["help"] = text;
    print_result(globals, result, text);
  });
}

void add_completion_command(CLI::App& app, const Globals& globals) {
  CLI::App* command =
      app.add_subcommand("completion", "Print the completions of commands, options and values for a shell");
  const auto shell = std::make_shared<std::string>();
  command->add_option("shell", *shell, "Shell")->check(CLI::IsMember({"bash", "zsh", "fish"}))->required();
  add_examples(*command,
               {"gonogo completion bash > ~/.local/share/bash-completion/completions/gonogo",
                "gonogo completion zsh > ~/.zfunc/_gonogo  # with fpath+=~/.zfunc before compinit",
                "gonogo completion fish > ~/.config/fish/completions/gonogo.fish"},
               "An installation puts them where the shells look. They ask the program at every Tab, and so fit its\n"
               "version. In a build folder: source <(build/cpu-release/gonogo completion bash)");
  command->callback([shell, &globals] {
    const std::string text = completion_script(*shell);
    Json result = Json::object();
    result["script"] = text;
    print_result(globals, result, text);
  });
}

namespace {

/// Text as roff takes it literally; a line that begins with a dot or a quote is no request.
std::string roff(const std::string& text) {
  std::string out;
  bool line_begins = true;
  for (const char c : text) {
    if (line_begins && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\')
      out += "\\e";
    else if (c == '-')
      out += "\\-";
    else if (c == '~')
      out += "\\(ti";
    else if (c == '^')
      out += "\\(ha";
    else
      out += c;
    line_begins = c == '\n';
  }
  return out;
}

std::string capitals(std::string text) {
  for (char& c : text) c = char(std::toupper(static_cast<unsigned char>(c)));
  return text;
}

/// A long list of choices breaks at its spaces.
std::string spaced(std::string choices) {
  for (std::size_t at = 0; (at = choices.find(',', at)) != std::string::npos; at += 2) choices.insert(at + 1, " ");
  return choices;
}

std::string value_text(const CLI::Option& option) {
  const Value value = value_of(option);
  return value.name.empty() ? "" : " \\fI" + spaced(roff(value.name)) + "\\fR" + (value.many ? " ..." : "");
}

std::string option_entry(const CLI::Option& option) {
  const std::string name = roff(option.nonpositional() ? option.get_name(false, true) : option.get_name(true, false));
  return ".TP\n\\fB" + name + "\\fR" + value_text(option) + "\n" + roff(option.get_description() + remarks(option)) +
         "\n";
}

/// Note and examples of a command's footer (add_examples).
std::string footer_text(const CLI::App& command) {
  const std::string footer = command.get_footer();
  const std::size_t gap = footer.rfind("\n\nExample");
  const bool has_note = gap != std::string::npos;
  const std::string examples = has_note ? footer.substr(gap + 2) : footer;
  const std::string note = has_note ? ".PP\n" + roff(footer.substr(0, gap)) + "\n" : "";
  return note + ".PP\n.nf\n" + roff(examples.substr(examples.find('\n') + 1)) + "\n.fi\n";
}

std::string usage(const CLI::App& command) {
  std::string text = "\\fB" + roff(full_name(command)) + "\\fR";
  for (const CLI::Option* positional : positionals_of(command)) {
    const bool many = value_of(*positional).many;
    const std::string name = "\\fI" + roff(positional->get_name(true, false)) + "\\fR" + (many ? " ..." : "");
    text += positional->get_required() ? " " + name : " [" + name + "]";
  }
  if (!options_of(command).empty()) text += " [\\fIoptions\\fR]";
  return text;
}

void add_commands_below(const CLI::App& command, std::string& text) {
  for (const CLI::App* below : commands_of(command)) {
    text += ".SS " + roff(full_name(*below)) + "\n" + roff(below->get_description()) + ".\n";
    if (commands_of(*below).empty()) {
      text += ".PP\n" + usage(*below) + "\n";
      for (const CLI::Option* positional : positionals_of(*below)) text += option_entry(*positional);
      for (const CLI::Option* option : options_of(*below)) text += option_entry(*option);
    }
    text += footer_text(*below);
    add_commands_below(*below, text);
  }
}

std::string man_page(const CLI::App& program) {
  const std::string version = program_version();
  std::string text = ".TH " + capitals(program.get_name()) + " 1 \"\" \"" + program.get_name() + " " + version +
                     "\" \"User Commands\"\n.SH NAME\ngonogo \\- " +
                     roff("mobility maps for off-road vehicles from simulated trials") + "\n";
  text += ".SH SYNOPSIS\n\\fBgonogo\\fR \\fIcommand\\fR [\\fIsubcommand\\fR] [\\fIoptions\\fR]\n";
  text += ".SH DESCRIPTION\n" + roff(program.get_description()) + "\n" + footer_text(program);
  text += ".SH OPTIONS\nThese may stand before or after the command.\n";
  for (const CLI::Option* option : options_of(program)) text += option_entry(*option);
  text += ".TP\n\\fB\\-h\\fR, \\fB\\-\\-help\\fR\nPrint the help of the program or of a command.\n";
  text += ".SH COMMANDS\n";
  add_commands_below(program, text);
  text += ".SH EXIT STATUS\n";
  for (const auto& [code, meaning] : {std::pair{"0", "success"},
                                      {"1", "device or program failure, or a check that does not hold"},
                                      {"2", "bad input"},
                                      {"130", "interrupted; the same command continues"}})
    text += std::string(".TP\n\\fB") + code + "\\fR\n" + roff(meaning) + "\n";
  text +=
      "With \\-\\-json the last line of standard output is one JSON object, which has the member \"error\" with\n"
      "\"kind\", \"message\" and, where they are known, \"file\", \"path\", \"line\" and \"column\" when the status is "
      "not 0.\n";
  return text;
}

}  // namespace

void add_man_command(CLI::App& app, const Globals& globals) {
  CLI::App* command = app.add_subcommand("man", "Print the man page of the program");
  add_examples(*command, {"gonogo man > gonogo.1", "gonogo man | man -l -"});
  command->callback([&app, &globals] {
    const std::string text = man_page(app);
    Json result = Json::object();
    result["page"] = text;
    print_result(globals, result, text);
  });
}

}  // namespace gonogo::app
