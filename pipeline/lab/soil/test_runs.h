// What the virtual soil tests of this folder share: runs side by side, and the beginning and end of an outcome.
#pragma once
#include <algorithm>
#include <mutex>
#include <string>
#include <vector>

#include "base/progress.h"
#include "pipeline/lab/soil/soil_tests.h"
#include "terrain/soil_test/line_fit.h"
#include "terrain/soil_test/plate.h"
#include "terrain/soil_test/shear.h"

namespace gonogo::lab {

/// Runs of one test side by side under one progress line.
class Runs {
 public:
  Runs(const std::string& test, const SoilTestRequest& request, std::size_t count, Index steps_each)
      : request_(request), count_(count), progress_("soil test " + test, "steps", count * std::size_t(steps_each)) {}

  /// job(k, pace) for each run.
  template <class Job>
  void operator()(Job job) {
    const int side_by_side = std::max(1, std::min(request_.threads, int(count_)));
    terrain::TestPace pace = request_.numerics ? terrain::pace_of(*request_.numerics) : terrain::TestPace{};
    pace.threads = std::max(1, request_.threads / side_by_side);
    pace.on_steps = [this](Index steps) {
      const std::lock_guard lock(mutex_);
      progress_.update(done_ += std::size_t(steps));
    };
    terrain::run_jobs(count_, side_by_side, [&](std::size_t k) { job(k, pace); });
    progress_.finish();
  }

 private:
  const SoilTestRequest& request_;
  std::size_t count_, done_ = 0;
  std::mutex mutex_;
  Progress progress_;
};

/// Steps in a test's unit of time: the test's own number, unless the request asks for the step of trials.
double steps_per_gravity_time(double own, const SoilTestRequest& r);
double steps_per_stress_time(double stress, double own, const SoilTestRequest& r);  // stress [Pa]

/// The soil of run k: its seed is k more.
terrain::TestSoil seeded(const SoilTestRequest& r, std::size_t k);

/// Stress [Pa] and seed of a run, for each stress and seed of the request.
struct Load {
  double stress;
  std::size_t seed;
};
std::vector<Load> loads_of(const SoilTestRequest& r);

/// An outcome that names test and soil.
SoilTestOutcome begin(const std::string& test, const SoilTestRequest& r);
void finish(SoilTestOutcome& o, double worst_residual);

Json angle_json(const terrain::Angle& a);

/// Results of all plates, the widths of one seed after those of another; and of shear tests, as loads_of() lists them.
/// `scene`: of the last one; may be null. run_plates throws InputError for fewer than two widths.
std::vector<terrain::PlateResult> run_plates(const SoilTestRequest& r, terrain::TestScene* scene);
std::vector<terrain::ShearResult> run_shear(const SoilTestRequest& r, terrain::TestScene* scene);

SoilTestOutcome shear(const SoilTestRequest& r);
SoilTestOutcome triaxial(const SoilTestRequest& r);
SoilTestOutcome plate(const SoilTestRequest& r);
SoilTestOutcome cone(const SoilTestRequest& r);

}  // namespace gonogo::lab
