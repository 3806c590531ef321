// What a map needs from a trained model: probabilities of outcomes, expected measures, top speed. read_map_request()
// makes one from model files; tests make their own.
#pragma once
#include <cstddef>
#include <functional>
#include <limits>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "base/json/config.h"
#include "base/units.h"
#include "pipeline/campaign/study/contract.h"
#include "pipeline/map/region/rules.h"
#include "vehicle/model/statics.h"

namespace gonogo::map {

/// Lower bound on the expected speed in route costs [m/s]. It keeps the time finite.
inline constexpr double kMinSpeed = 0.05;
/// Expected measures (speed, slip, sinkage, energy per metre) of trials that passed, as a quadratic in each variable:
///
///   m(x) = c + sum_v (a_v z_v + b_v z_v^2),  z_v the variable scaled to [-1, 1] over the trials
///
/// It is fitted by ridge regression. The ridge parameter minimises the leave-one-out error (Golub, Heath, Wahba 1979).
/// The fit has no cross terms because a few dozen trials do not determine them. Without them an unknown variable can be
/// replaced by its mean over the trials.
struct MeasureFit {
  std::string name, unit;
  std::vector<double> middle, half_width;  // [variables] z = (x - middle) / half_width; half_width 0: did not vary
  std::vector<double> linear, quadratic;   // [variables]
  std::vector<double> mean_z, mean_z2;     // [variables] over the trials, for unknown variables
  double constant = 0;
  double lowest = 0, highest = 0;  // range seen in the trials; SlopeMeasure is clamped to it
  double error = 0, spread = 0;    // leave-one-out RMSE; standard deviation [unit]
  std::size_t trials = 0;

  /// m(x) [unit], not clamped. NaN marks an unknown variable.
  double value(std::span<const double> variables) const;
};

/// points: [rows x variables], row by row. value: [rows]; rows with NaN are left out. Fewer than 12 rows give a
/// constant.
MeasureFit fit_measure(std::string name, std::string unit, std::span<const double> points,
                       std::span<const double> value);

/// A measure on one soil as a function of the slopes along and across the heading [deg].
struct SlopeMeasure {
  double base = 0, along = 0, along2 = 0, across = 0, across2 = 0, lowest = 0, highest = 0;
  double at(BedSlopes slopes) const;
};

/// Mean of the fit over the points that the soil may be. The slopes in `points` are ignored.
SlopeMeasure on_soil(const MeasureFit& fit, const std::vector<std::vector<double>>& points);

/// Density of the soil that is thrown forward [kg/m^3]: about the largest in configs/soils/usda.json.
inline constexpr double kThrownDensity = 2100;

/// What a trial that drove steadily under its own power measured.
struct ResistanceTrial {
  double resistance = 0;  // motion resistance over the load on the ground [-]
  double rut = 0;         // [m]
  double slip = 0;        // [-]
  double speed = 0;       // of the treads [m/s]
};

/// Motion resistance as a linear function, by least squares. Answers are kept within what was measured.
struct ResistanceFit {
  double constant = 0, per_rut = 0, per_slip = 0, per_speed = 0;  // [-], [1/m], [-], [s/m]
  double lowest = 0, highest = 0;                                 // measured [-]
  double fastest = 0;                                             // tread speed that trials reached [m/s]
  double error = 0, spread = 0;                                   // RMSE; standard deviation [-]
  std::size_t trials = 0;

  double at(double rut, double slip, double tread_speed) const;
};

/// Fewer than 12 trials give their mean; none gives zeros.
ResistanceFit fit_resistance(std::span<const ResistanceTrial> trials);

/// Top speed of a vehicle on a soil, where the driveline's tractive force equals what slope and soil take:
///
///   F(v_t) = W (max(0, tan(along)) + R) + w z rho (v^2 - v_s^2)      v = (1 - slip) v_t
///
/// F is the tractive force at the tread speed v_t, W the weight across the ground, R the motion resistance that trials
/// measured at the cell's slip and rut depth z. The trials drove up to the speed v_s. Beyond it the last term is added:
/// the soil in ruts of width w is thrown forward at the vehicle's speed. Downhill the vehicle drives as on the level.
///
/// Not in it: ride, sight, brakes, bends, air. A limit for these is given as max_speed.
///
/// A vehicle as its top speed needs it.
struct SpeedModel {
  vehicle::TractiveForce drive;
  double gravity = kGravity;  // [m/s^2]
  double mass = 0;            // without payload [kg]
  double tyre_stiffness = 0;  // of all tyres together [N/m]; 0: rigid
  double rut_width = 0;       // of all ruts together [m]
  ResistanceFit resistance;
  MeasureFit slip, sinkage;  // of trials that passed [-], [m]

  /// Depth of the rut [m] under wheels that sink so far [m] and give way under this load [N].
  double rut(double sinks, double load) const;
};

/// Top speed on one soil.
class SoilSpeed {
 public:
  /// `points`: what the soil may be; the payload and the fits are averaged over them. max_speed [m/s] limits all.
  SoilSpeed(const SpeedModel& model, const std::vector<std::vector<double>>& points,
            double max_speed = std::numeric_limits<double>::infinity());

  /// [m/s]; at least kMinSpeed.
  double at(BedSlopes slopes) const;

 private:
  SpeedModel model_;
  SlopeMeasure slip_, sinkage_;
  double payload_ = 0;  // [kg]
  double max_speed_;
};

/// Min cone indices of fine-grained soil for a vehicle (vehicle/semi_empirical/mobility_index.h).
struct ConeIndexNeed {
  std::string vehicle;
  double one_pass = 0, fifty_passes = 0;  // VCI1, VCI50: for one and for fifty passes [Pa]
};

/// P(go) of probabilities of outcomes [outcome count].
double p_go_of(std::span<const double> outcome);

/// See OutcomeModel::on_slopes.
using SlopeAnswers = std::function<void(std::span<const double> points, std::span<const double> along,
                                        std::span<const double> across, std::span<double> result)>;

struct OutcomeModel {
  /// Box of the trials that answer for a point [variable count].
  const std::vector<Range>& box_of(std::span<const double> point) const {
    return !crossing_sampled.empty() && campaign::has_task_values(point) ? crossing_sampled : sampled;
  }

  /// Probabilities of the outcomes of contract() for many points at once. NaN marks an unknown variable.
  /// points: [point count x variable count], row by row. result: [point count x outcome count]. Each row of the result
  /// sums to 1 and depends on its own point only.
  std::function<void(std::span<const double> points, std::span<double> result)> probabilities;
  /// The same at every pair of slopes [deg], for points without a task; slopes in `points` are ignored. result:
  /// [point][along][across][outcome]. Empty: `probabilities` is asked about every pair.
  SlopeAnswers on_slopes;
  /// The same for bootstrap members of the model (pipeline/outcome/training/train_model.h). Their answers widen the
  /// interval on P(go). Empty: the uncertainty of the model is left out of the interval.
  std::vector<std::function<void(std::span<const double> points, std::span<double> result)>> members;
  /// Box in which trials were simulated [variable count]. A variable that was held fixed has equal ends.
  std::vector<Range> sampled;
  /// The same for points with a ditch (crossing_model.h); empty: no trial answers for them.
  std::vector<Range> crossing_sampled;
  /// Distance of a point from the trials, as Predictor::novelty(). Empty: the map gets no novelty layer.
  std::function<double(std::span<const double> point)> novelty;
  /// The same for a point without a task, straight uphill at slopes that rise [deg]. Empty: `novelty` is asked.
  std::function<void(std::span<const double> point, std::span<const double> slopes, std::span<double> result)>
      novelty_uphill;
  std::vector<MeasureFit> measures;  // fitted to trials that passed; empty without a dataset
  std::optional<SpeedModel> speed;   // none: no top speed is given
  std::vector<std::string> remarks;  // one sentence each, for readers of the map
  std::vector<std::string> member_hashes;
  std::string dataset_hash;                 // of the file that `measures` come from; empty without one
  std::string hash;                         // of the model's file
  std::string crossing_hash;                // of the file of the model for ditches; empty without one
  std::string vehicle;                      // name for titles, may be empty
  double gravity = kGravity;                // of the trials [m/s^2]
  bool whole_vehicle = false;               // measures are of all wheels, not of one
  std::optional<ConeIndexNeed> cone_index;  // of the vehicle; none: fine-grained soil is unknown
};

/// Answers that cost much, by the bits of what was asked: entries of a soil table for a firm, a soft and an unmeasured
/// soil, and soils with a sample in common, ask for the same. Thread-safe.
class KeptAnswers {
 public:
  /// Fills `answer` from memory, or by `compute` the first time.
  void fill(std::span<const std::span<const double>> asked, std::span<double> answer,
            const std::function<void(std::span<double>)>& compute);

 private:
  std::mutex mutex_;
  std::unordered_map<std::string, std::vector<double>> answers_;
  std::size_t size_ = 0;  // numbers in them
};

// Ditches on a map, answered by a model of trials that cross them.
//
// A point of the contract with a ditch in it, ditch_width and ditch_depth above 0, is put to both models. The least of
// the two P(go) counts. Both are about one event chain on one ground: who crosses the ditch has driven the ground
// around it, so that P(both) = P(ditch) where the models are right, and P(both) <= min in any case (Frechet). A product
// would take the two for independent, and count weak soil twice.

/// Lets `model` answer for points with a ditch. Every outcome probability of such a point is that of the model with
/// the lower P(go). Where that is the crossing model, all that does not go is no_go/obstacle: the soil alone lets it
/// pass. `crossing_sampled` becomes the box of both models, and that of `crossing` in the sizes of ditches. Its trials
/// lie in deeper soft soil than a trench needs; shallower soil is no weaker, so that a smaller bed_depth counts as
/// theirs. Members of `crossing` are left out.
void add_crossing_model(OutcomeModel& model, const OutcomeModel& crossing);

}  // namespace gonogo::map
