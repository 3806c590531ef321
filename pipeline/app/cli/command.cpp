#include "pipeline/app/cli/command.h"

namespace gonogo::app {

std::string one_of(const std::vector<std::string>& words) {
  std::string name;
  for (const std::string& word : words) name += (name.empty() ? "{" : ",") + word;
  return name + "}";
}

void add_examples(CLI::App& command, const std::vector<std::string>& lines, const std::string& note) {
  std::string footer = note.empty() ? "" : note + "\n\n";
  footer += lines.size() == 1 ? "Example:" : "Examples:";
  for (const std::string& line : lines) footer += "\n  " + line;
  command.footer(footer);
}

}  // namespace gonogo::app
