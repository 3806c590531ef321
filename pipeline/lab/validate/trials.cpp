#include "pipeline/lab/validate/trials.h"

#include <algorithm>
#include <cmath>

#include "base/progress.h"

namespace gonogo::lab {

std::vector<campaign::DesignPoint> replicates(const std::vector<double>& variables, int count) {
  std::vector<campaign::DesignPoint> points;
  for (int i = 0; i < count; ++i) {
    campaign::DesignPoint p;
    p.index = p.seed = std::uint64_t(i);
    p.variables = variables;
    points.push_back(p);
  }
  return points;
}

std::vector<double> plain_variables(const campaign::TrialSetup& setup, double slope_along, double friction_angle,
                                    double speed) {
  std::vector<double> values(campaign::contract().variables.size(), 0);
  const auto set = [&](const char* name, double x) { values[campaign::contract().variable_index(name)] = x; };
  set("slope_along", slope_along);
  set("friction_angle", friction_angle);
  set("relative_density", 0.5);
  set("tyre_friction", setup.whole ? setup.whole->wheel.front().friction : 0.8);
  set("bed_depth", 0.3);
  set("commanded_speed", speed);
  return values;
}

std::vector<campaign::TrialRecord> run_trials(const campaign::TrialSetup& setup,
                                              const std::vector<campaign::DesignPoint>& points,
                                              const campaign::BatchSettings& batch,
                                              const std::vector<campaign::TrialWatch>& watch) {
  campaign::prepare_trials(setup, points, batch.threads);
  campaign::TrialBatch trials(setup, batch);
  std::vector<campaign::TrialRecord> records(points.size());
  Progress progress("validate", "trials", points.size());
  for (std::size_t next = 0, done = 0; done < points.size(); progress.update(done)) {
    for (; trials.free_places() > 0 && next < points.size(); ++next)
      trials.start(points[next], next < watch.size() ? watch[next] : campaign::TrialWatch{});
    for (campaign::TrialRecord& r : trials.advance()) {
      records[std::size_t(r.point.index)] = std::move(r);
      ++done;
    }
  }
  return records;
}

}  // namespace gonogo::lab
