// The local engine: workers are processes of this machine.
#pragma once
#include "pipeline/campaign/engine/crew.h"

namespace gonogo::campaign {

/// Program and arguments of a process that calls run_worker, the `worker`-th of its crew.
using WorkerCommand = std::function<std::vector<std::string>(std::size_t worker)>;

std::unique_ptr<Crew> process_crew(std::size_t size, WorkerCommand command);

}  // namespace gonogo::campaign
