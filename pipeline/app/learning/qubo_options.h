// Options that the commands below gonogo qubo share.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "pipeline/app/cli/command.h"
#include "pipeline/outcome/qubo/qubo_embed.h"
#include "pipeline/outcome/qubo/qubo_exchange.h"

namespace gonogo::app {

struct QuboOptions {
  std::string model, problem, answer, out, rows, sampler = "block_gibbs", decode = "weigh";
  std::string answer_format = "dimod_json";
  outcome::FileChoice in, to;
  learning::SamplerSettings sampling;
  outcome::DeviceChoice device;
  outcome::EmbedRequest embed;
  double chain_strength = 0;
  std::uint64_t gauge = 0;
  std::string chains = "weighted_random";
  std::vector<std::string> clamp;
  double penalty = 0;
  outcome::ImportLimits limits;
  bool spin = false, inside = false;
  std::size_t reads = 1000, sweeps = 1000;
  std::uint64_t seed = 1;
};

using SharedQubo = std::shared_ptr<QuboOptions>;

/// Names of all formats of problems.
std::vector<std::string> format_names();

/// Options of a file that is read.
void add_input_options(CLI::App* command, const SharedQubo& options);

void print_export(const Globals& globals, const std::string& path, const outcome::Exported& exported);

void add_qubo_contact(CLI::App& qubo, const Globals& globals);
void add_qubo_import(CLI::App& qubo, const SharedQubo& options, const Globals& globals);

}  // namespace gonogo::app
