#include "base/error.h"
#include "pipeline/app/cli/command.h"

namespace gonogo::app {

void add_left_out_command(CLI::App& app, const std::string& name, const std::string& option) {
  const std::string sentence =
      name + ": left out of this build (" + option + "=OFF); configure with -D" + option + "=ON and build again";
  CLI::App* command = app.add_subcommand(name, "not in this build: needs " + option + "=ON");
  command->allow_extras();
  command->callback([sentence] { throw InputError(sentence); });
}

}  // namespace gonogo::app
