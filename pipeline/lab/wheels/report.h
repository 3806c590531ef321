// Measured and predicted in one table: ours, formulas and what others published.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "pipeline/lab/wheels/agreement.h"
#include "pipeline/lab/wheels/run.h"

namespace gonogo::lab {

/// A bound of a benchmark and what the simulation has there.
struct CheckedBound {
  Bound bound;
  double measured = 0;
  bool holds() const { return measured <= bound.at_most; }  // false for NaN
};

struct WheelReport {
  Benchmark benchmark;
  WheelOutcome outcome;
  std::vector<Predictor> predictor;  // the simulation first, where there were trials
  std::vector<std::string> missing;  // why a predictor is not in the table
  std::vector<CheckedBound> check;   // of the simulation
};

/// Adds what others published and checks the bounds. `formulas`: predictors to stand after the simulation.
WheelReport report_of(const Benchmark& b, const WheelOutcome& outcome, const std::vector<Predictor>& formulas,
                      const std::vector<std::string>& missing);

/// A published prediction at the benchmark's points, interpolated along its led quantity; the end values beyond.
Predictor interpolated(const Benchmark& b, const PublishedPrediction& published);

/// Points whose first led quantity is at most `up_to`.
std::vector<ComparedValue> compared(const Benchmark& b, const Predictor& p, Quantity q,
                                    double up_to = std::numeric_limits<double>::infinity());

/// What trials gave in an earlier run, from its wheels.json, for each of these benchmarks. Slips over time are not in
/// it. Throws InputError for a benchmark that is not in the file or has other points there.
std::vector<WheelOutcome> read_outcomes(const std::filesystem::path& file, const std::vector<Benchmark>& benchmarks);

Json as_json(const WheelReport& r);
std::string as_text(const WheelReport& r);
/// Number of bounds that do not hold.
int failures(const WheelReport& r);

/// <benchmark>.csv, <benchmark>_<quantity>.png, and <benchmark>_over_time.csv on slopes. Pictures where the build has
/// them.
void write_report(const std::filesystem::path& folder, const WheelReport& report);

/// wheels.json of all and wheels.png: predicted over measured, of all wheels.
void write_overview(const std::filesystem::path& folder, const std::vector<WheelReport>& reports);

}  // namespace gonogo::lab
