// Wheels measured by others, as data (configs/benchmarks/*.json, schema configs/schema/benchmark.json): wheel, load and
// soil with sources, what was led, and what was measured.
#pragma once
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "base/json/config.h"
#include "terrain/soil/soil.h"
#include "vehicle/model/vehicle.h"

namespace gonogo::lab {

/// What an experiment led or measured. Slip [-], angles [deg], load and forces [N], torque [N m], sinkage [m]. Signs as
/// in the schema.
enum class Quantity { slip, slope, slip_angle, load, pull, traction_slope, side_force, torque, sinkage };

/// Its name, and its column: name and unit. traction_slope is atan(pull / load).
const char* name_of(Quantity q);
const char* column_of(Quantity q);
const char* unit_of(Quantity q);
/// Throws InputError, at `where`, that lists the names there are.
Quantity quantity_named(const std::string& name, const Config& where, const std::string& key);

/// Mean and span of the tests at a point.
struct Measured {
  double mean = 0, low = 0, high = 0;
  int tests = 0;
};

struct BenchmarkPoint {
  std::map<Quantity, double> led;  // and the load where it is the point's own
  std::map<Quantity, Measured> measured;
};

/// Number that no source gives exactly: what is taken, and between which bounds it may lie.
struct Assumed {
  double value = 0, low = 0, high = 0;
};

/// A number that a prediction is held against.
struct Bound {
  Quantity quantity = Quantity::pull;
  std::string measure;  // of agreement.h
  double at_most = 0;
  double up_to = std::numeric_limits<double>::infinity();  // of the first led quantity
  std::string why;
};

/// What others published for the same points.
struct PublishedPrediction {
  std::string name, source;
  std::vector<BenchmarkPoint> point;  // ascending in the led quantity
};

struct Benchmark {
  std::string name, title, about, source, licence, assumed;  // name: of the file
  std::filesystem::path vehicle_file;                        // empty: the wheel is given by itself
  vehicle::Vehicle vehicle;                                  // of the file, or a quarter under the least load
  double load = 0;                                           // on the wheel; 0: by point, or the vehicle's weight [N]
  Assumed wheel_friction;                                    // [-]
  std::string soil_file;                                     // its name
  std::filesystem::path soil_path;
  terrain::SoilState soil;
  double rim_turning = 0;  // [rad/s]; 0: by rule
  double way = 0;          // of the carriage to the middle of what was averaged [m]; 0: by rule
  bool slip_at_lugs = false, sinkage_from_lugs = false;
  std::vector<Quantity> led;
  std::vector<BenchmarkPoint> point;  // that are run
  std::map<Quantity, double> scatter;
  std::vector<Bound> bound;
  std::vector<PublishedPrediction> published;

  bool leads(Quantity q) const;
  /// Quantities that some point has measured, in the order of the enumeration.
  std::vector<Quantity> measured() const;
  /// Half of the span in which a prediction agrees with the measurement of a point: of its repeats, or what the file
  /// says where that is more. 0: not known.
  double scatter_at(const BenchmarkPoint& p, Quantity q) const;
};

/// A file, or a name in configs/benchmarks. Throws InputError for a benchmark without source, units or led quantities,
/// and for anything that the schema does not allow.
Benchmark read_benchmark(const std::string& name_or_file);
/// Whether a whole vehicle drives, not one wheel.
inline bool is_whole(const Benchmark& b) { return !vehicle::is_quarter(b.vehicle); }
/// The wheel that slip, sinkage and pressures belong to.
inline const vehicle::Wheel& wheel_of(const Benchmark& b) { return b.vehicle.wheel.front(); }
/// Another state of its soil; an empty name changes nothing. Throws InputError that lists the states there are.
void choose_state(Benchmark& b, const std::string& state);
/// Names of all that ship.
std::vector<std::string> benchmark_names();

/// Points of a CSV: rows with the same led quantities are one point, in the order of first appearance.
std::vector<BenchmarkPoint> read_points(const std::filesystem::path& file, const std::vector<Quantity>& led);

}  // namespace gonogo::lab
