// Options of commands that simulate grains: device, time step and contact solver.
#pragma once
#include <map>
#include <string>

#include "pipeline/app/cli/command.h"
#include "terrain/bed/bed.h"
#include "terrain/soil/calibration.h"

namespace gonogo::app {

/// Devices by name, see add_choice().
inline const std::map<std::string, sim::Backend> kBackends{{"cpu", sim::Backend::cpu}, {"cuda", sim::Backend::cuda}};

/// --step, --substeps, --iterations, --tolerance, --give, --target. `whose` begins each description: "Trials".
void add_numerics_options(CLI::App& command, terrain::Numerics& numerics, const std::string& whose);

/// The same for commands that meet a soil through a table: what is not given is the table's. `tolerance`: whether
/// --tolerance is among them.
void add_asked_numerics_options(CLI::App& command, terrain::AskedNumerics& asked, const std::string& whose,
                                bool tolerance = true);

/// --wheel-rolling.
void add_wheel_rolling_option(CLI::App& command, double& rolling);

/// Whether any of the numerics was given.
bool numerics_given(const CLI::App& command);

}  // namespace gonogo::app
