#include "pipeline/app/cli/table.h"

#include <sstream>

namespace gonogo::app {
namespace {

constexpr std::size_t kHelpWidth = 110;  // characters in a line

std::vector<std::string> split(const std::string& text, char at) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == at)
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

/// Text between the first `open` and the last `close`; empty where there is none.
std::string between(const std::string& text, char open, char close) {
  const std::size_t first = text.find(open), last = text.rfind(close);
  return first == std::string::npos || last == std::string::npos ? "" : text.substr(first + 1, last - first - 1);
}

/// Breaks at blanks so that no line has more than `width` characters, where words are short enough.
std::string wrapped(const std::string& text, std::size_t width) {
  std::string out;
  std::size_t length = 0;
  for (const std::string& word : split(text, ' ')) {
    const bool breaks = length > 0 && length + 1 + word.size() > width;
    if (length > 0) out += breaks ? '\n' : ' ';
    out += word;
    length = (breaks || length == 0 ? 0 : length + 1) + word.size();
  }
  return out;
}

std::string plain_name(const std::string& type) {
  if (type == "UINT") return "INT";
  return type == "FLOAT" ? "NUMBER" : type;
}

void add_options(const CLI::App& command, bool positional, std::vector<const CLI::Option*>& result) {
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_group().empty() || option == command.get_help_ptr()) continue;
    if (positional ? option->get_positional() : option->nonpositional()) result.push_back(option);
  }
  for (const CLI::App* group : command.get_subcommands([](const CLI::App* c) { return c->get_name().empty(); }))
    add_options(*group, positional, result);
}

}  // namespace

// CLI11 gives "INT:INT in [1 - 100]" for a range, "TEXT:{a,b}" for a choice, and a type name alone otherwise.
Value value_of(const CLI::Option& option) {
  Value value;
  if (option.get_type_size() == 0) return value;
  const std::string type = option.get_type_name();
  const std::string choices = between(type, '{', '}'), limits = between(type, '[', ']');
  value.name = choices.empty() ? plain_name(type.substr(0, type.find(':'))) : "{" + choices + "}";
  if (!choices.empty()) value.choices = split(choices, ',');
  if (const std::size_t dash = limits.find(" - "); dash != std::string::npos)
    value.limits = limits.substr(0, dash) + " to " + limits.substr(dash + 3);
  value.initial = option.get_default_str();
  if (value.initial.size() > 1 && value.initial.front() == '[' && value.initial.back() == ']')
    value.initial = value.initial.substr(1, value.initial.size() - 2);
  value.many = option.get_expected_max() > 1;
  return value;
}

std::string remarks(const CLI::Option& option) {
  const Value value = value_of(option);
  std::string text = value.limits;
  const auto add = [&text](const std::string& part) { text += (text.empty() ? "" : "; ") + part; };
  if (!value.initial.empty()) add("default " + value.initial);
  if (option.get_required() && option.nonpositional()) add("required");
  for (const CLI::Option* other : option.get_excludes()) add("not with " + other->get_name());
  return text.empty() ? "" : " (" + text + ")";
}

std::vector<const CLI::Option*> options_of(const CLI::App& command) {
  std::vector<const CLI::Option*> result;
  add_options(command, false, result);
  return result;
}

std::vector<const CLI::Option*> positionals_of(const CLI::App& command) {
  std::vector<const CLI::Option*> result;
  add_options(command, true, result);
  return result;
}

const CLI::Option* option_named(const CLI::App& command, const std::string& name) {
  for (const CLI::App* at = &command; at != nullptr; at = at->get_parent())
    for (const CLI::Option* option : options_of(*at))
      if (option->check_name(name)) return option;
  return nullptr;
}

std::vector<const CLI::App*> commands_of(const CLI::App& command) {
  return command.get_subcommands([](const CLI::App* c) { return !c->get_name().empty() && !c->get_group().empty(); });
}

const CLI::App* command_named(const CLI::App& command, const std::string& name) {
  for (const CLI::App* below : commands_of(command))
    if (below->get_name() == name) return below;
  return nullptr;
}

std::vector<std::string> names_of(const std::vector<const CLI::App*>& commands) {
  std::vector<std::string> names;
  for (const CLI::App* command : commands) names.push_back(command->get_name());
  return names;
}

std::string full_name(const CLI::App& command) {
  return (command.get_parent() ? full_name(*command.get_parent()) + " " : "") + command.get_name();
}

std::string help_of(const CLI::App& command) {
  return command.get_formatter()->make_help(&command, full_name(command), CLI::AppFormatMode::Normal);
}

std::string HelpFormat::make_option_opts(const CLI::Option* option) const {
  const Value value = value_of(*option);
  return value.name.empty() ? "" : " " + value.name + (value.many ? " ..." : "");
}

std::string HelpFormat::make_option_desc(const CLI::Option* option) const {
  return wrapped(option->get_description() + remarks(*option), kHelpWidth - get_column_width());
}

std::string HelpFormat::make_description(const CLI::App* command) const {
  return wrapped(command->get_description(), kHelpWidth) + "\n";
}

std::string HelpFormat::make_subcommand(const CLI::App* command) const {
  std::ostringstream out;
  CLI::detail::format_help(out, command->get_name(),
                           wrapped(command->get_description(), kHelpWidth - get_column_width()), get_column_width());
  return out.str();
}

}  // namespace gonogo::app
