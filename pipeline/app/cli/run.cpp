#include "pipeline/app/run/run.h"

#include "pipeline/app/cli/command.h"

namespace gonogo::app {

void add_run_command(CLI::App& app, const Globals& globals) {
  CLI::App* command = app.add_subcommand("run", "The main job: simulate, learn and map what a study asks for");
  auto request = std::make_shared<RunRequest>();
  command->add_option("study", request->study, "JSON file of the study")->required();
  command->add_option("--out", request->out, "Folder for the results; the same folder continues an interrupted run")
      ->required();
  command->footer(
      "Trials, training and map are each done only when something they depend on has changed.\n\n"
      "Example:\n  gonogo run configs/studies/demo.json --out out/demo");
  command->callback([request, &globals] {
    request->threads = globals.threads;
    const RunSummary summary = run_study(*request);
    print_result(globals, summary.record, to_text(summary));
  });
}

}  // namespace gonogo::app
