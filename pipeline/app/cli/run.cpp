#include <memory>

#include "pipeline/app/cli/command.h"

namespace gonogo::app {

void add_run_command(CLI::App& app, const Globals& globals, const Work<RunRequest>& work) {
  CLI::App* command = app.add_subcommand("run", "The main job: simulate, learn and map what a study asks for");
  const auto request = std::make_shared<RunRequest>();
  command->add_option("study", request->study, "JSON file of the study")->type_name(kStudy)->required();
  command->add_option("--out", request->out, "Folder for the results; the same folder continues an interrupted run")
      ->type_name(kFolder)
      ->required();
  add_examples(*command, {"gonogo run configs/studies/demo.json --out out/demo"},
               "Trials, training and map are each done only when something they depend on has changed.");
  command->callback([request, work, &globals] { work(globals, *request); });
}

}  // namespace gonogo::app
