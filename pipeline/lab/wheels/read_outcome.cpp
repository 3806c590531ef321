#include <cmath>

#include "base/format.h"
#include "base/json/config.h"
#include "pipeline/lab/wheels/report.h"

namespace gonogo::lab {
namespace {

Predicted read_predicted(const Config& c) {
  return {c.number("mean"), c.number("standard_error"), c.number("low"), c.number("high")};
}

/// Fails where the file's point is not that of the benchmark.
std::map<Quantity, Predicted> read_point(const Config& c, const BenchmarkPoint& point, const std::string& predictor) {
  for (const auto& [quantity, value] : point.led)
    if (quantity != Quantity::load && std::fabs(c.number(column_of(quantity)) - value) > 1e-6)
      c.fail(column_of(quantity), "is not " + number_text(value) + " as in the benchmark; run its trials again");
  std::map<Quantity, Predicted> predicted;
  for (const auto& [quantity, measured] : point.measured)
    if (const auto of = c.object_if(column_of(quantity)))
      if (const auto own = of->object_if(predictor)) predicted[quantity] = read_predicted(*own);
  return predicted;
}

WheelOutcome read_outcome(const Config& c, const Benchmark& b) {
  WheelOutcome o;
  o.bed.grain = c.number("grain_m", {1e-4, 1});
  const std::vector<double> bed = c.numbers("bed_m", {0, 100});
  if (bed.size() != 3) c.fail("bed_m", "needs three numbers: length, width and depth");
  o.bed.length = bed[0];
  o.bed.width = bed[1];
  o.bed.depth = bed[2];
  o.bed.time = c.number("drive_s", {0, 1e6});
  o.grains_per_width = c.number("grains_per_width", {0, 1e6});
  o.lug_grains = lug_grains(wheel_of(b), o.bed.grain);
  o.trials = int(c.integer("trials", {1, 1e9}));
  o.failed = int(c.integer("failed_trials", {0, double(o.trials)}));
  o.varied = c.texts("band_over");
  const std::vector<Config> points = c.objects("points");
  if (points.size() != b.point.size())
    c.fail("points", "has " + std::to_string(points.size()) + " points, the benchmark " +
                         std::to_string(b.point.size()) + "; run its trials again");
  o.predictor.name = kOurs;
  for (std::size_t i = 0; i < points.size(); ++i)
    o.predictor.point.push_back(read_point(points[i], b.point[i], o.predictor.name));
  return o;
}

}  // namespace

std::vector<WheelOutcome> read_outcomes(const std::filesystem::path& file, const std::vector<Benchmark>& benchmarks) {
  const Config c = Config::read(file);
  std::vector<WheelOutcome> outcomes;
  for (const Benchmark& b : benchmarks) {
    if (!c.has(b.name)) c.fail(b.name, "is not in the file; name only benchmarks that are");
    outcomes.push_back(read_outcome(c.object(b.name), b));
  }
  return outcomes;
}

}  // namespace gonogo::lab
