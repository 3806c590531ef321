// The program as CLI11 sees it: its own options and all commands.
#pragma once
#include <memory>

#include "pipeline/app/cli/command.h"

namespace gonogo::app {

/// `globals` must outlive the program.
std::unique_ptr<CLI::App> make_program(Globals& globals);

/// Whether the words ask for a result as JSON, also where they do not parse.
bool asks_for_json(const std::vector<std::string>& words);

/// One sentence about a line that does not parse, with the nearest command or option when a word is unknown.
std::string explain(const CLI::App& program, const CLI::ParseError& error, const std::vector<std::string>& words);

}  // namespace gonogo::app
