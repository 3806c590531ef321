// The trials of benchmarks: which setups, at which points, for which of the assumed numbers.
#pragma once
#include "pipeline/lab/wheels/run.h"

namespace gonogo::lab {

/// One set of the numbers that a benchmark gives as ranges.
struct AssumedCase {
  std::string what;  // "wheel friction 0.3"; empty: all as the benchmark takes them
  double wheel_friction = 0;
  terrain::MacroscopicSoil soil{};
};

/// The nominal case first; with `band` then both ends of every range. Ends that mean the same grains are left out.
std::vector<AssumedCase> cases_of(const Benchmark& b, const terrain::Calibration& calibration, bool band);

struct PlannedTrial {
  const campaign::TrialSetup* setup = nullptr;
  campaign::DesignPoint point;
  std::size_t benchmark = 0, at = 0, of_case = 0;  // indices; `at`: of the benchmark's point
};

struct WheelPlan {
  std::vector<std::unique_ptr<campaign::TrialSetup>> setup;
  std::vector<PlannedTrial> trial;
  std::vector<WheelOutcome> outcome;         // [benchmark], without predictions
  std::vector<double> rim_speed, tip_speed;  // [benchmark] of the rim, of the lugs' tips [m/s]
};

WheelBed bed_of(const Benchmark& b, const WheelRun& run);

/// Rim speed of a benchmark [m/s]: as it says, but no less than 0.25 sqrt(g r). Experiments are slower than that, down
/// to speeds that no simulation can afford.
double rim_speed_of(const Benchmark& b);

WheelPlan plan_wheels(const std::vector<Benchmark>& benchmarks, const WheelRun& run);

}  // namespace gonogo::lab
