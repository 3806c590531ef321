#include "pipeline/app/cli/command.h"

#include <cstdio>

namespace gonogo::app {
namespace {

bool printed = false;

void write_out(const std::string& text) {
  const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size();
  if (!written || std::fflush(stdout) != 0)
    throw DeviceError("standard output: cannot write the result (is the disk full?)");
}

std::string kind_of(ExitCode code) {
  switch (code) {
    case ExitCode::bad_input:
      return "bad_input";
    case ExitCode::interrupted:
      return "interrupted";
    default:
      return "failure";
  }
}

}  // namespace

void print_result(const Globals& globals, const Json& result, const std::string& text) {
  printed = true;
  std::string out = globals.json ? result.dump() : text;
  if (!out.empty() && out.back() != '\n') out += '\n';
  write_out(out);
}

void print_row(const Globals& globals, const std::string& text) {
  if (!globals.json) write_out(text);
}

bool result_printed() { return printed; }

Json error_json(ExitCode code, const std::string& message, const InputPlace& place) {
  Json error = Json::object();
  error["kind"] = kind_of(code);
  error["message"] = message;
  if (!place.file.empty()) error["file"] = place.file;
  if (!place.path.empty()) error["path"] = place.path;
  if (place.line > 0) error["line"] = std::uint64_t(place.line);
  if (place.column > 0) error["column"] = std::uint64_t(place.column);
  return error;
}

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

void add_family(CLI::App& command, FamilyChoice& choice, const std::string& about) {
  CLI::Option* from_family = command.add_flag("--from-family", choice.from_family, about);
  add_named(command, "--family-model", choice.model, kModel, "Model of the family; default: the one that ships")
      ->needs(from_family);
}

}  // namespace gonogo::app
