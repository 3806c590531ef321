// The scripts by which shells complete; their texts are completion/gonogo.{bash,zsh,fish}.
#pragma once
#include <string>

namespace gonogo::app {

std::string bash_completion();
std::string zsh_completion();
std::string fish_completion();

}  // namespace gonogo::app
