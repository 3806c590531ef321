// Completions: candidates for the last word of a command line, and the scripts by which shells ask for them.
#pragma once
#include <string>
#include <vector>

#include "pipeline/app/cli/command.h"

namespace gonogo::app {

/// `line`: words after the program's name; the last one is unfinished and may be empty. Returns one line per candidate,
/// with a description after a tab where there is one. The last line says which files of the disk may also stand there:
/// ":none", ":file" or ":folder".
std::string completions(const CLI::App& program, const std::vector<std::string>& line);

/// The script by which "bash", "zsh" or "fish" complete: completion/gonogo.<shell>.
std::string completion_script(const std::string& shell);

}  // namespace gonogo::app
