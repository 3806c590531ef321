#include "learning/hardware/corrected_annealer.h"

#include <cmath>

#include "base/cancel.h"
#include "base/random.h"
#include "learning/sampler/bipartite.h"
#include "learning/sampler/block_gibbs.h"

namespace gonogo::learning {
namespace {

enum Stream : std::uint64_t { kTuning = 31, kProbe, kRows, kPost };

constexpr double kStrengths[] = {0.6, 0.8, 1.0};  // |J| inside chains, from weak to the limit of the range
constexpr double kBroken = 0.02;                  // share of broken chains that a weaker strength may have
constexpr std::size_t kRounds = 10;               // measurements of the temperature
constexpr double kNear = 0.02;                    // of beta to 1

SampleSet with_post_sweeps(const Problem& problem, SampleSet rows, const SampleRequest& request, std::size_t sweeps) {
  const bool possible = sweeps > 0 && split_in_two(to_qubo(problem));
  rows.info["post_sweeps"] = Json(std::uint64_t(possible ? sweeps : 0));
  if (!possible) return rows;
  SampleRequest more;
  more.reads = rows.row_count();
  more.seed = random_bits(request.seed, kPost, 0);
  more.sweeps = sweeps;
  more.start = &rows;
  SampleSet result = BlockGibbs().sample(problem, more);
  result.info = rows.info;
  return result;
}

}  // namespace

CorrectedAnnealer::CorrectedAnnealer(std::shared_ptr<const Sampler> device, const HardwareGraph& graph,
                                     Embedding embedding, const CorrectionSettings& settings)
    : device_(std::move(device)), graph_(graph), embedding_(std::move(embedding)), settings_(settings) {}

AnnealerSampler CorrectedAnnealer::tuned(const Problem& problem, const SampleRequest& request,
                                         double chain_coupling) const {
  AnnealerSettings settings;
  settings.chain_coupling = chain_coupling;
  settings.gauges = settings_.programmings;
  settings.ranges = settings_.ranges;
  settings.susceptibility = settings_.susceptibility;
  AnnealerSampler sampler(device_, graph_, embedding_, problem.variable_count(), settings);
  sampler.set_scale(std::min(settings_.first_scale, sampler.largest_scale(problem)));
  TemperatureControl control(sampler, Thermometer::pseudo_likelihood, settings_.probe_reads, request.sweeps,
                             random_bits(request.seed, kTuning, 0));
  for (std::size_t round = 0; round < kRounds; ++round) {
    stop_if_cancelled();
    const double scale = sampler.scale();
    control.update(round, problem);
    if (std::abs(control.log().back().beta - 1) > kNear && sampler.scale() != scale) continue;
    sampler.set_scale(scale);
    break;
  }
  return sampler;
}

SampleSet CorrectedAnnealer::sample(const Problem& problem, const SampleRequest& request) const {
  for (double strength : kStrengths) {
    const AnnealerSampler sampler = tuned(problem, request, strength);
    SampleRequest probe = request;
    probe.reads = settings_.probe_reads;
    probe.seed = random_bits(request.seed, kProbe, 0);
    const double broken = sampler.sample(problem, probe).info.at("chain_break_fraction").number();
    if (broken > kBroken && strength != kStrengths[2]) continue;
    SampleRequest final = request;
    final.seed = random_bits(request.seed, kRows, 0);
    SampleSet rows = sampler.sample(problem, final);
    const BetaEstimate left = pseudo_likelihood_beta(problem, rows, request.seed);
    rows.info["chain_coupling"] = strength;
    rows.info["beta"] = left.beta;
    rows.info["beta_low"] = left.low;
    rows.info["beta_high"] = left.high;
    rows.info["masked_pairs"] = Json(std::uint64_t(embedding_.uncoupled.size()));
    rows.info["programmings"] = Json(std::uint64_t(std::min(settings_.programmings, request.reads)));
    return with_post_sweeps(problem, std::move(rows), request, settings_.post_sweeps);
  }
  return {};  // not reached: the last strength always answers
}

}  // namespace gonogo::learning
