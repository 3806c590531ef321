// What may stand in the place of the last word of a line: the question that the completion scripts ask.
#pragma once
#include <string>
#include <vector>

#include "pipeline/app/cli/command.h"

namespace gonogo::app {

/// `line`: words after the program's name, the last one unfinished, maybe empty. Returns a line for each candidate,
/// with a description after a tab where there is one, and a last line ":none", ":file" or ":folder": what files of the
/// disk may also stand there.
std::string completions(const CLI::App& program, const std::vector<std::string>& line);

}  // namespace gonogo::app
