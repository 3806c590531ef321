#include "pipeline/lab/wheels/run.h"

#include <algorithm>
#include <cmath>

#include "pipeline/lab/validate/trials.h"
#include "pipeline/lab/wheels/plan.h"
#include "terrain/soil_test/test_run.h"

namespace gonogo::lab {

std::vector<double> slip_over_time(const std::vector<Way>& ways, double speed) {
  std::size_t seconds = 0, trials = 0;
  for (const Way& w : ways) {
    if (w.x.empty()) continue;
    seconds = trials == 0 ? w.x.size() - 1 : std::min(seconds, w.x.size() - 1);
    ++trials;
  }
  std::vector<double> slip(seconds, 0);
  for (const Way& w : ways)
    for (std::size_t i = 0; i < seconds && !w.x.empty(); ++i)
      slip[i] += (1 - (w.x[i + 1] - w.x[i]) / speed) / double(trials);
  return slip;
}

namespace {

using Values = std::map<Quantity, std::vector<double>>;  // one of each bed

/// What a trial gives, as the benchmark counts it.
void add_values(const Benchmark& b, const campaign::TrialSetup& setup, const campaign::TrialRecord& r, Values& to) {
  const vehicle::Wheel& wheel = wheel_of(b);
  if (b.leads(Quantity::slope)) {
    to[Quantity::slip].push_back(slip_from_rim(b, wheel, campaign::measure_of(r, "slip")));
    to[Quantity::sinkage].push_back(sinkage_from_tips(b, wheel, campaign::measure_of(r, "sinkage")));
    to[Quantity::torque].push_back(campaign::measure_of(r, "mean_torque"));
    return;
  }
  if (r.pull.empty()) return;
  const campaign::PullPoint& p = r.pull.front();
  const double load = setup.weight(campaign::variable_of(r, "payload"));
  to[Quantity::pull].push_back(p.pull * load);
  to[Quantity::traction_slope].push_back(terrain::angle_of_tangent(p.pull, 0).degrees);
  to[Quantity::side_force].push_back(p.side * load);
  to[Quantity::torque].push_back(p.torque);
  to[Quantity::sinkage].push_back(sinkage_from_tips(b, wheel, p.sinkage));
}

/// Records in the order of the trials, those of one batch side by side.
std::vector<campaign::TrialRecord> run_planned(const std::vector<PlannedTrial>& trials, const WheelRun& run,
                                               std::vector<Way>& ways) {
  const sim::Backend backend = run.gpu ? sim::Backend::cuda : sim::Backend::cpu;
  campaign::TrialBatch batch(*trials.front().setup, {backend, run.gpu ? int(trials.size()) : run.threads, run.threads});
  return run_batch(batch, trials.size(), [&](std::size_t i) {
    campaign::DesignPoint point = trials[i].point;
    point.index = i;
    batch.start(*trials[i].setup, point, ways[i].watch());
  });
}

/// Trials of one grain size, which run as one batch.
struct Group {
  std::vector<std::size_t> member;  // of the plan's trials
  double work = 0;                  // grains times time, up to a factor
};

/// The group with the least work first, so that its results are there early.
std::vector<Group> groups_of(const WheelPlan& plan) {
  std::vector<Group> groups;
  for (std::size_t k = 0; k < plan.trial.size(); ++k) {
    const campaign::TrialSetup& setup = *plan.trial[k].setup;
    const auto own = std::find_if(groups.begin(), groups.end(), [&](const Group& g) {
      return campaign::same_steps(setup, *plan.trial[g.member.front()].setup);
    });
    Group& group = own != groups.end() ? *own : groups.emplace_back();
    group.member.push_back(k);
    const WheelBed& bed = plan.outcome[plan.trial[k].benchmark].bed;
    group.work += bed.length * setup.bed_width * bed.depth / std::pow(bed.grain, 3) * setup.time_limit;
  }
  std::stable_sort(groups.begin(), groups.end(), [](const Group& a, const Group& b) { return a.work < b.work; });
  return groups;
}

void settle_beds(const WheelPlan& plan, const WheelRun& run) {
  for (const auto& setup : plan.setup) {
    std::vector<campaign::DesignPoint> points;
    for (const PlannedTrial& t : plan.trial)
      if (t.setup == setup.get()) points.push_back(t.point);
    campaign::prepare_trials(*setup, points, run.threads);
  }
}

/// Fills the records of a group's trials and what their observers saw.
void run_group(const WheelPlan& plan, const Group& group, const WheelRun& run,
               std::vector<campaign::TrialRecord>& records, std::vector<Way>& ways) {
  std::vector<PlannedTrial> trials;
  std::vector<Way> seen;
  for (const std::size_t k : group.member) {
    trials.push_back(plan.trial[k]);
    seen.push_back(ways[k]);
  }
  std::vector<campaign::TrialRecord> of_group = run_planned(trials, run, seen);
  for (std::size_t i = 0; i < group.member.size(); ++i) {
    records[group.member[i]] = std::move(of_group[i]);
    ways[group.member[i]] = seen[i];
  }
}

/// Means of all cases at a point; the first case is the nominal one.
std::map<Quantity, Predicted> predicted(const std::vector<Values>& cases) {
  std::map<Quantity, Predicted> at;
  for (const auto& [quantity, values] : cases.front()) {
    const MeanError nominal = mean_error(values);
    Predicted p{nominal.mean, nominal.error, nominal.mean, nominal.mean};
    for (const Values& one : cases) {
      const auto found = one.find(quantity);
      if (found == one.end()) continue;
      const double mean = mean_error(found->second).mean;
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
  o.predictor.name = kOurs;
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

std::vector<WheelOutcome> run_wheels(const std::vector<Benchmark>& benchmarks, const WheelRun& run,
                                     const WheelDone& done) {
  const WheelPlan plan = plan_wheels(benchmarks, run);
  settle_beds(plan, run);
  std::vector<campaign::TrialRecord> records(plan.trial.size());
  std::vector<Way> ways;
  for (const PlannedTrial& t : plan.trial) ways.push_back(Way{t.setup->park_time, {}});
  std::vector<WheelOutcome> outcomes(benchmarks.size());
  for (const Group& group : groups_of(plan)) {
    run_group(plan, group, run, records, ways);
    // All trials of a benchmark have its grain size.
    for (std::size_t i = 0; i < benchmarks.size(); ++i) {
      const auto is_own = [&](std::size_t k) { return plan.trial[k].benchmark == i; };
      if (std::none_of(group.member.begin(), group.member.end(), is_own)) continue;
      outcomes[i] = outcome_of(benchmarks[i], i, plan, records, ways);
      if (done) done(i, outcomes[i]);
    }
  }
  return outcomes;
}

}  // namespace gonogo::lab
