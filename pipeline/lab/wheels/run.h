// Runs the trials of a benchmark and reduces them to its quantities.
#pragma once
#include <functional>
#include <memory>
#include <optional>

#include "pipeline/campaign/trial/trial.h"
#include "pipeline/lab/wheels/benchmark.h"

namespace gonogo::lab {

/// Places of a trial's wheel at the end of each second of its driving [m], from its observer. Must stay where it is
/// while it watches.
struct Way {
  double from = 0;  // park time [s]
  std::vector<double> x;

  campaign::TrialWatch watch() {
    campaign::TrialWatch w;
    w.start = [this] { x.clear(); };
    w.sample = [this](const campaign::TrialSample& s) {
      if (s.time >= from + double(x.size()) - 1e-9) x.push_back(s.x);
    };
    return w;
  }
};

/// Mean over the trials, of each second that all have driven. `speed`: of the circle at which slip counts [m/s].
std::vector<double> slip_over_time(const std::vector<Way>& ways, double speed);

// Benchmarks of wheels through a calibration, untuned: trials on beds of grains that have the benchmark's soil.

/// How benchmarks are run. Sizes of zero are by rule, the same for all wheels (bed_of).
struct WheelRun {
  std::filesystem::path calibration;                   // of the grains
  double grain = 0, depth = 0, length = 0, width = 0;  // of the grains; of the bed [m]
  double time = 0;                                     // of driving; its last half counts [s]
  int seeds = 2;                                       // beds per point
  int threads = 1;                                     // trials at a time
  bool gpu = false;                                    // all trials of one grain size as one batch
  bool quick = false;                                  // coarse grains, small beds, few points, no band
  bool band = true;                                    // also at both ends of every range
  std::string state;                                   // of the soil; empty: the benchmark's
  std::optional<double> wheel_friction;                // in the place of the benchmark's
  double wheel_rolling = 1;                            // see TrialSetup; grains are as angular on a rim as on grains
  terrain::AskedNumerics numerics;                     // in the place of the table's
                                                       // unless the run is quick
};

/// Grains and bed of a benchmark by the rule, or as asked: for a wheel of reach R (with lugs) and width b, grains of
/// b / 10, or as large as the lugs where these are lower, down to b / 20; a bed 8 R long, 3.5 times as wide as the
/// wheel across the way and 0.8 R deep, driven over 6.4 radii of rim.
/// Under slip angles: grains of b / 8, a bed twice as deep, driven until the carriage, too, has gone three radii,
/// or for twice the time.
/// Whole vehicles: 14 R long, folded, driven twice as far. Quick: b / 5, 6 R, 2.5, 0.6 R, half as far.
struct WheelBed {
  double grain = 0, length = 0, width = 0, depth = 0, time = 0;  // [m], [s], the least of its points; width 0: folded
};

/// A quantity at a point: mean and standard error over the beds, and its least and greatest mean over what is assumed.
struct Predicted {
  double mean = campaign::kNaN, error = 0, low = campaign::kNaN, high = campaign::kNaN;
};

inline constexpr const char* kOurs = "gonogo";  // name of the trials among the predictors

/// Predictions for each point of a benchmark, and where they come from.
struct Predictor {
  std::string name, about;
  std::vector<std::map<Quantity, Predicted>> point;
};

/// What trials of a benchmark gave.
struct WheelOutcome {
  Predictor predictor;
  WheelBed bed;
  double lug_grains = 0;  // height of the lugs over the grains' radius; 0: no lugs
  double grains_per_width = 0;
  std::vector<std::string> varied;                  // what the band is over
  int trials = 0, failed = 0;                       // run; of them, unknown
  std::vector<std::vector<double>> slip_over_time;  // [point] of each second on a given slope
  bool coarse() const { return lug_grains > 0 && lug_grains < 1; }
};

/// Points of the benchmark that a quick run takes: at most three, first, middle and last of the order led.
void keep_quick_points(Benchmark& b);

/// Called with the index of a benchmark as soon as its trials have ended.
using WheelDone = std::function<void(std::size_t, const WheelOutcome&)>;

/// Runs all benchmarks, those of one grain size side by side. Throws InputError that begins with the benchmark for a
/// soil that the table does not reach and for a bed too small. Outcomes in the order of the benchmarks.
std::vector<WheelOutcome> run_wheels(const std::vector<Benchmark>& benchmarks, const WheelRun& run,
                                     const WheelDone& done = {});

/// Mean normal stress under the wheel [Pa]: the mean load on its width times half its radius, from where a rigid wheel
/// that is sunk by an eighth of its radius meets the soil to its lowest point.
double mean_stress(const Benchmark& b);
/// The benchmark's soil with its strength as it acts at that stress (terrain/soil/evidence.h).
terrain::MacroscopicSoil acting_soil(const Benchmark& b, terrain::MacroscopicSoil measured);
/// What is assumed of it, in one sentence; empty where its cohesion was measured at that stress, or is none.
std::string strength_remark(const Benchmark& b);

/// The load on the wheel at a point [N].
double load_at(const Benchmark& b, const BenchmarkPoint& p);
/// Height of the lugs over the grains' radius; 0 without lugs.
double lug_grains(const vehicle::Wheel& wheel, double grain);

/// Slip at the benchmark's circle from that of the rim, and back. Both are 1 - v / (w r).
double slip_from_rim(const Benchmark& b, const vehicle::Wheel& wheel, double slip);
double slip_of_rim(const Benchmark& b, const vehicle::Wheel& wheel, double slip);
/// Sinkage as the benchmark counts it from that of the tips [m].
double sinkage_from_tips(const Benchmark& b, const vehicle::Wheel& wheel, double sinkage);

}  // namespace gonogo::lab
