// The program as CLI11 sees it: its own options and all commands.
#pragma once
#include <memory>

#include "pipeline/app/cli/command.h"

namespace gonogo::app {

class Program : public CLI::App {
 public:
  bool parse_only = false;  // a line that parses ends with CLI::Success, and no command works

 private:
  void pre_callback() override {
    if (parse_only) throw CLI::Success();
  }
};

/// `globals` must outlive the program.
std::unique_ptr<Program> make_program(Globals& globals);

/// Whether the words ask for a result as JSON, also where they do not parse.
bool asks_for_json(const std::vector<std::string>& words);

/// One sentence about a line that does not parse, with the nearest command or option when a word is unknown.
std::string explain(const CLI::App& program, const CLI::ParseError& error, const std::vector<std::string>& words);

}  // namespace gonogo::app
