#include "pipeline/app/cli/complete.h"

#include <set>

#include "base/files/shipped.h"
#include "pipeline/app/cli/table.h"
#include "pipeline/campaign/study/contract.h"

namespace gonogo::app {
namespace {

struct Candidate {
  std::string word, about;
};

/// State of the line before the cursor.
struct Cursor {
  const CLI::App* command;                 // the deepest named
  const CLI::Option* waiting = nullptr;    // option whose value comes next
  bool may_end = false;                    // the waiting option has a value already and takes more
  bool options_over = false;               // after --
  std::vector<std::string> positionals{};  // of the command, so far
};

void pass(Cursor& at, const std::string& word) {
  const bool is_option = !at.options_over && word.size() > 1 && word[0] == '-';
  if (at.waiting != nullptr && word == "=") return;  // bash makes --option=value three words
  if (at.waiting != nullptr && !(at.may_end && is_option)) {
    at.may_end = value_of(*at.waiting).many;
    if (!at.may_end) at.waiting = nullptr;
    return;
  }
  at.waiting = nullptr;
  at.may_end = false;
  if (word == "--") {
    at.options_over = true;
  } else if (is_option) {
    const CLI::Option* option = option_named(*at.command, word.substr(0, word.find('=')));
    const bool open = word.find('=') == std::string::npos && option != nullptr &&
                      option->get_items_expected_max() != 0;  // a flag takes none
    if (open) at.waiting = option;
  } else if (const CLI::App* below = command_named(*at.command, word); below && at.positionals.empty()) {
    at.command = below;
  } else {
    at.positionals.push_back(word);
  }
}

std::vector<Candidate> shipped(const std::string& kind, bool tables) {
  std::set<std::string> names;  // the same name may lie in several folders
  const std::string table = "calibration";
  for (const auto& folder : shipped_folders(kind))
    for (const std::string& name : shipped_names(folder))
      if ((name.rfind(table, 0) == 0) == tables) names.insert(name);
  std::vector<Candidate> result;
  for (const std::string& name : names) result.push_back({name, ""});
  return result;
}

std::vector<Candidate> shipped_models() {
  std::vector<Candidate> result;
  for (const auto& folder : shipped_data_folders("model.h5")) result.push_back({folder.filename().string(), ""});
  return result;
}

std::vector<Candidate> contract_names(const std::string& after, bool measures) {
  std::vector<Candidate> result;
  for (const auto& v : campaign::contract().variables) result.push_back({v.name + after, v.unit});
  if (!measures) return result;
  for (const auto& m : campaign::contract().measures) result.push_back({m.name, m.unit});
  return result;
}

std::vector<Candidate> commands(const CLI::App& command) {
  std::vector<Candidate> result;
  for (const CLI::App* below : commands_of(command)) result.push_back({below->get_name(), below->get_description()});
  return result;
}

/// Commands below the one that the words name from the program down.
std::vector<Candidate> commands_below(const CLI::App& program, const std::vector<std::string>& words) {
  const CLI::App* at = &program;
  for (const std::string& word : words) {
    at = command_named(*at, word);
    if (at == nullptr) return {};
  }
  return commands(*at);
}

std::vector<Candidate> options(const CLI::App& command) {
  std::vector<Candidate> result;
  for (const CLI::App* at = &command; at != nullptr; at = at->get_parent())
    for (const CLI::Option* option : options_of(*at))
      for (const std::string& name : option->get_lnames()) result.push_back({"--" + name, option->get_description()});
  result.push_back({"--help", "Print this help"});
  return result;
}

struct Answer {
  std::vector<Candidate> candidates;
  std::string files = ":none";
};

Answer values(const CLI::App& program, const Cursor& at, const CLI::Option& option) {
  const Value value = value_of(option);
  if (value.name == kFolder) return {{}, ":folder"};
  if (value.name == kFile || value.name == kStudy) return {{}, ":file"};
  if (value.name == kModel) return {shipped_models(), ":file"};
  if (value.name == kVehicle) return {shipped("vehicles", false), ":file"};
  if (value.name == kSoil) return {shipped("soils", false), ":file"};
  if (value.name == kBenchmark) return {shipped("benchmarks", false), ":file"};
  if (value.name == kTable) return {shipped("soils", true), ":file"};
  if (value.name == kVariable) return {contract_names("", true)};
  if (value.name == kSetting) return {contract_names("=", false)};
  if (value.name == kCommand) return {commands_below(program, at.positionals)};
  Answer answer;
  for (const std::string& choice : value.choices) answer.candidates.push_back({choice, ""});
  return answer;
}

/// The next positional; null where the command takes no more.
const CLI::Option* next_positional(const Cursor& at) {
  const std::vector<const CLI::Option*> all = positionals_of(*at.command);
  if (all.empty()) return nullptr;
  if (at.positionals.size() < all.size()) return all[at.positionals.size()];
  return value_of(*all.back()).many ? all.back() : nullptr;
}

Answer at_cursor(const CLI::App& program, const Cursor& at, const std::string& word) {
  const bool dash = !at.options_over && !word.empty() && word[0] == '-';
  if (at.waiting != nullptr && !(at.may_end && dash)) return values(program, at, *at.waiting);
  if (dash) return {options(*at.command)};
  Answer answer;
  if (const CLI::Option* positional = next_positional(at)) answer = values(program, at, *positional);
  if (at.positionals.empty())
    for (const Candidate& c : commands(*at.command)) answer.candidates.push_back(c);
  return answer;
}

}  // namespace

std::string completions(const CLI::App& program, const std::vector<std::string>& line) {
  Cursor at{.command = &program};
  std::string word;
  if (!line.empty()) {
    for (std::size_t i = 0; i + 1 < line.size(); ++i) pass(at, line[i]);
    word = line.back();
  }
  if (at.waiting != nullptr && word == "=") word.clear();
  std::string stem;  // "--option=", part of the word where the shell does not split there
  const std::size_t equals = word.find('=');
  if (word.rfind("--", 0) == 0 && equals != std::string::npos) {
    stem = word.substr(0, equals + 1);
    at.waiting = option_named(*at.command, word.substr(0, equals));
    at.may_end = false;
  }
  const Answer answer = at.waiting == nullptr && !stem.empty() ? Answer{} : at_cursor(program, at, word);
  std::string text;
  for (const Candidate& c : answer.candidates)
    if ((stem + c.word).rfind(word, 0) == 0) text += stem + c.word + (c.about.empty() ? "" : "\t" + c.about) + "\n";
  return text + answer.files + "\n";
}

}  // namespace gonogo::app
