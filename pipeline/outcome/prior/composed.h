// A vehicle of a family composed of its wheels: the coarse fidelity beside trials of whole vehicles. Regressions on
// trials of wheels by themselves say what a wheel of these numbers pulls, along and to its side, and how deep it stands
// in this soil at a given slip and slip angle. Statics puts wheels together: the weight of a rigid vehicle on equal
// springs, shifted back by the slope. On a slope across, all wheels turn at the slip angle whose side force holds the
// vehicle, and then pull less along: a vehicle that was composed without it leaned to go.
//
// All wheels turn at one slip, as those of the family's trials do, whose motors hold one speed. Open differentials,
// which let the lightest wheel spin, pull less than this.
#pragma once
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "base/hdf5/hdf5.h"
#include "base/json/config.h"
#include "base/units.h"
#include "learning/rbm/regression/gaussian_process.h"
#include "pipeline/campaign/dataset/dataset.h"
#include "vehicle/family/vehicle_numbers.h"

namespace gonogo::outcome {

/// What a composed vehicle has beyond what its slope needs.
struct ComposedMargins {
  double traction = 0;   // largest pull of its wheels over the weight that the slope across leaves, less tan(slope)
  double drive = 0;      // tractive force over the weight at the commanded speed, less tan(slope), in [-1, 1]
  double clearance = 0;  // of the belly over the diameter, less the sinkage where wheels pull most
  double standing = 0;   // slope at which it tips over, less the slope, as tangents: the least of uphill, downhill and
                         // to a side, in [-1, 1]
};

/// Whether these trials are of wheels by themselves.
bool are_of_wheels(const std::vector<campaign::TrialRecord>& records);

class ComposedVehicle {
 public:
  static constexpr std::size_t kInputs = 4;  // of ComposedMargins

  /// Learns trials of wheels of a diameter, for vehicles on wheels of another [m], at one gravity [m/s^2]. Throws
  /// InputError, which `where` starts, for fewer than 50 valid ones.
  ComposedVehicle(const std::vector<campaign::TrialRecord>& wheels, const std::string& where, double wheel_diameter = 1,
                  double vehicle_diameter = 1, double gravity = kGravity);

  /// point: variables of the contract, of a whole vehicle of the family.
  std::vector<ComposedMargins> margins(std::span<const double> points) const;
  /// The same as inputs [point count x kInputs].
  std::vector<double> inputs(std::span<const double> points) const;

  /// Pull and side force over load and sinkage [m] of wheels. points: as those of the trials.
  std::vector<double> pull(std::span<const double> points) const;
  std::vector<double> side_force(std::span<const double> points) const;
  std::vector<double> sinkage(std::span<const double> points) const;

  /// As a group of a file, and from there, with the same answers.
  void write(Hdf5Writer& out, const std::string& group) const;
  static ComposedVehicle read(const Hdf5Reader& in, const std::string& group);

 private:
  ComposedVehicle() = default;

  double unit_speed_ = 0;                  // sqrt(g D) of the vehicle's wheels [m/s]
  double scale_ = 1, wheel_diameter_ = 1;  // of lengths, from the vehicle's wheels to those of the trials; of these [m]
  std::vector<Range> box_;                 // of the trials, by variable
  learning::GaussianRegression pull_, side_force_, sinkage_;

  ComposedMargins margins_of(std::span<const double> asked) const;
};

}  // namespace gonogo::outcome
