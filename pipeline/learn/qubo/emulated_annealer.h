// Samples problem files on an emulated annealer.
#pragma once
#include <memory>

#include "learning/hardware/corrected_annealer.h"
#include "learning/hardware/emulator.h"
#include "pipeline/learn/qubo/qubo_embed.h"

namespace gonogo::learn {

struct DeviceChoice {
  GraphChoice graph;             // default: that of a D-Wave 2X
  double temperature = 0.2;      // in units of the fields h
  std::size_t post_sweeps = 10;  // of block Gibbs after the device, if the problem is bipartite
  bool as_programmed = false;    // nothing is corrected: the file's coefficients are programmed, on its qubits
};

/// The device with the errors of a D-Wave 2X on the chosen graph.
learning::Device emulated_device(const DeviceChoice& choice);

/// The corrected sampler of `problem`, which is over variables and is embedded here.
learning::CorrectedAnnealer corrected_annealer(const learning::Problem& problem, const learning::Device& device,
                                               std::size_t post_sweeps);

/// Samples a problem on the device. Corrected rows (corrected_annealer.h) answer a problem over variables, which is
/// embedded here, or one that gonogo qubo embed wrote; its chains then come back unbroken. Writes the answer as
/// sample_problem() does, and adds what was corrected, and what is left. Throws InputError if the problem does not fit.
Json sample_emulated(const std::filesystem::path& problem, const std::filesystem::path& answer,
                     const DeviceChoice& choice, const learning::SampleRequest& request, const FileChoice& file = {});

}  // namespace gonogo::learn
