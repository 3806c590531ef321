#include "pipeline/app/cli/completion.h"

#include <memory>

#include "pipeline/app/cli/command.h"

namespace gonogo::app {

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
    const std::string text = *shell == "bash"  ? bash_completion()
                             : *shell == "zsh" ? zsh_completion()
                                               : fish_completion();
    Json result = Json::object();
    result["script"] = text;
    print_result(globals, result, text);
  });
}

}  // namespace gonogo::app
