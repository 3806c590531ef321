#include "pipeline/lab/wheels/run.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/progress.h"
#include "pipeline/lab/wheels/over_time.h"
#include "pipeline/lab/wheels/plan.h"
#include "terrain/soil_test/line_fit.h"

namespace gonogo::lab {
namespace {

using Values = std::map<Quantity, std::vector<double>>;  // one of each bed

/// What a trial gives, as the benchmark counts it.
void add_values(const Benchmark& b, const campaign::TrialSetup& setup, const campaign::TrialRecord& r, Values& to) {
  const vehicle::WheelRig wheel = wheel_of(b);
  if (b.leads(Quantity::slope)) {
    to[Quantity::slip].push_back(slip_from_rim(b, wheel, campaign::measure_of(r, "slip")));
    to[Quantity::sinkage].push_back(sinkage_from_tips(b, wheel, campaign::measure_of(r, "sinkage")));
    to[Quantity::torque].push_back(campaign::measure_of(r, "mean_torque"));
    return;
  }
  if (r.pull.empty()) return;
  const campaign::PullPoint& p = r.pull.front();
  const double load = setup.weight(r.point.variables[campaign::contract().variable_index("payload")]);
  to[Quantity::pull].push_back(p.pull * load);
  to[Quantity::traction_slope].push_back(terrain::angle_of_tangent(p.pull, 0).degrees);
  to[Quantity::side_force].push_back(p.side * load);
  to[Quantity::torque].push_back(p.torque);
  to[Quantity::sinkage].push_back(sinkage_from_tips(b, wheel, p.sinkage));
}

/// Records in the order of the trials, those of one batch side by side.
std::vector<campaign::TrialRecord> run_batch(const std::vector<PlannedTrial>& trials, const WheelRun& run,
                                             std::vector<Way>& ways) {
  std::vector<campaign::TrialRecord> records(trials.size());
  const sim::Backend backend = run.gpu ? sim::Backend::cuda : sim::Backend::cpu;
  campaign::TrialBatch batch(*trials.front().setup, {backend, run.gpu ? int(trials.size()) : run.threads, run.threads});
  Progress progress("validate", "trials", trials.size());
  std::size_t next = 0, done = 0;
  for (; done < trials.size(); progress.update(done)) {
    for (; batch.free_places() > 0 && next < trials.size(); ++next) {
      campaign::DesignPoint point = trials[next].point;
      point.index = next;
      batch.start(*trials[next].setup, point, ways[next].watch());
    }
    for (campaign::TrialRecord& r : batch.advance()) {
      records[std::size_t(r.point.index)] = std::move(r);
      ++done;
    }
  }
  return records;
}

/// Settles beds, then runs the trials in batches of one grain size each.
std::vector<campaign::TrialRecord> run_trials_of(const WheelPlan& plan, const WheelRun& run, std::vector<Way>& ways) {
  for (const auto& setup : plan.setup) {
    std::vector<campaign::DesignPoint> points;
    for (const PlannedTrial& t : plan.trial)
      if (t.setup == setup.get()) points.push_back(t.point);
    campaign::prepare_trials(*setup, points, run.threads);
  }
  std::vector<campaign::TrialRecord> records(plan.trial.size());
  std::vector<bool> taken(plan.trial.size(), false);
  for (std::size_t first = 0; first < plan.trial.size(); ++first) {
    if (taken[first]) continue;
    std::vector<std::size_t> members;
    std::vector<PlannedTrial> group;
    std::vector<Way> seen;
    for (std::size_t k = first; k < plan.trial.size(); ++k) {
      if (taken[k] || !campaign::same_steps(*plan.trial[k].setup, *plan.trial[first].setup)) continue;
      taken[k] = true;
      members.push_back(k);
      group.push_back(plan.trial[k]);
      seen.push_back(ways[k]);
    }
    std::vector<campaign::TrialRecord> of_group = run_batch(group, run, seen);
    for (std::size_t i = 0; i < members.size(); ++i) {
      records[members[i]] = std::move(of_group[i]);
      ways[members[i]] = seen[i];
    }
  }
  return records;
}

/// Means of all cases at a point; the first case is the nominal one.
std::map<Quantity, Predicted> predicted(const std::vector<Values>& cases) {
  std::map<Quantity, Predicted> at;
  for (const auto& [quantity, values] : cases.front()) {
    const terrain::MeanError nominal = terrain::mean_error(values);
    Predicted p{nominal.mean, nominal.error, nominal.mean, nominal.mean};
    for (const Values& one : cases) {
      const auto found = one.find(quantity);
      if (found == one.end()) continue;
      const double mean = terrain::mean_error(found->second).mean;
      p.low = std::min(p.low, mean);
      p.high = std::max(p.high, mean);
    }
    at[quantity] = p;
  }
  return at;
}

WheelOutcome outcome_of(const Benchmark& b, std::size_t index, const WheelPlan& plan,
                        const std::vector<campaign::TrialRecord>& records, const std::vector<Way>& ways) {
  WheelOutcome o = plan.outcome[index];
  const std::size_t cases = o.varied.size() + 1;
  std::vector<std::vector<Values>> values(b.point.size(), std::vector<Values>(cases));
  std::vector<std::vector<Way>> nominal(b.point.size());
  for (std::size_t k = 0; k < records.size(); ++k) {
    const PlannedTrial& t = plan.trial[k];
    if (t.benchmark != index) continue;
    ++o.trials;
    if (records[k].verdict == campaign::Verdict::unknown) {
      ++o.failed;
      continue;
    }
    add_values(b, *t.setup, records[k], values[t.at][t.of_case]);
    if (t.of_case == 0) nominal[t.at].push_back(ways[k]);
  }
  o.predictor.name = "gonogo";
  for (std::size_t i = 0; i < b.point.size(); ++i) {
    o.predictor.point.push_back(predicted(values[i]));
    if (b.leads(Quantity::slope))
      o.slip_over_time.push_back(slip_over_time(nominal[i], plan.tip_speed[index] * (b.slip_at_lugs ? 1 : 0) +
                                                                plan.rim_speed[index] * (b.slip_at_lugs ? 0 : 1)));
  }
  return o;
}

}  // namespace

void keep_quick_points(Benchmark& b) {
  if (b.point.size() <= 3) return;
  b.point = {b.point.front(), b.point[b.point.size() / 2], b.point.back()};
}

std::vector<WheelOutcome> run_wheels(const std::vector<Benchmark>& benchmarks, const WheelRun& run) {
  const WheelPlan plan = plan_wheels(benchmarks, run);
  std::vector<Way> ways;
  for (const PlannedTrial& t : plan.trial) ways.push_back(Way{t.setup->park_time, {}});
  const std::vector<campaign::TrialRecord> records = run_trials_of(plan, run, ways);
  std::vector<WheelOutcome> outcomes;
  for (std::size_t i = 0; i < benchmarks.size(); ++i)
    outcomes.push_back(outcome_of(benchmarks[i], i, plan, records, ways));
  return outcomes;
}

}  // namespace gonogo::lab
