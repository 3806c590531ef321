#include "pipeline/app/run/run.h"

#include "pipeline/app/work/work.h"

namespace gonogo::app {

void run_work(const Globals& globals, const RunRequest& request) {
  RunRequest asked = request;
  asked.threads = globals.threads;
  const RunSummary summary = run_study(asked);
  print_result(globals, summary.record, to_text(summary));
}

}  // namespace gonogo::app
