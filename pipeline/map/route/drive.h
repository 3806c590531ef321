// Chance to get through along a way.
//
// Cells are not independent: soil, payload, errors of the elevation and of the model last over many of them. A draw
// chooses all that nobody knows and drives the whole way on it. The chance is the share of the draws that no piece
// stops. A draw consists of:
//
//   mission    payload and the like: one value for the whole way
//   soil       one of the points that the soil may be. A soil keeps its point along the way with the correlation
//              exp(-distance / soil_length)
//   elevation  Horn's gradient of independent errors of all cells, so that neighbouring slopes err alike
//   model      the model or one of its bootstrap members, for the whole way
//   the rest   a piece stops the vehicle if P(go) < Phi(-z). z is a normal field over the variables with the
//   correlation
//              exp(-distance^2 / 2), in units of `likeness` times the sampled ranges. A share `bed_share` of its
//              variance is drawn anew every `bed_length` instead.
//
// The last rule leaves P(go) of each piece as it is. Alike pieces end alike, because trials repeated on other beds do.
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/map/evaluate/outcome_model.h"

namespace gonogo::map {

/// What a soil on the way may be: equally likely points over the variables of the contract, NaN where unknown. All of
/// them lie in the sampled box; slopes are ignored.
struct DriveSoil {
  std::string name;
  std::vector<std::vector<double>> points;  // [point][variable]
  double not_sampled = 0;                   // share of the soil that no trial answers for; not among the points
};

/// A piece of the way inside one cell.
struct DrivePiece {
  double begin = 0, end = 0;             // distance on the ground from the start of the way [m]
  std::size_t soil = 0;                  // position in the list of soils
  double rise_east = 0, rise_north = 0;  // uphill gradient of the ground [rise per metre]
  double heading = 0;                    // [deg clockwise from grid north]
  int column = 0, row = 0;               // cell; equal cells err alike
};

/// Rises per metre along the heading (uphill positive) and across it (left side up positive).
struct SlopesOnWay {
  double along = 0, across = 0;
};
/// `error`: of the gradient, {east, north} [rise per metre].
SlopesOnWay slopes_on_way(const DrivePiece& piece, std::array<double, 2> error = {0, 0});

struct DriveDoubt {
  double soil_length = 1000;                 // [m] > 0
  double likeness = 0.3;                     // length of the rest's field [sampled range of a variable] > 0
  double bed_share = 0.05;                   // [0, 1]
  double bed_length = 100;                   // [m] > 0; also joins stops that are nearer into one place
  double height_error = 0;                   // standard error of a cell's height that its neighbours do not share [m]
  double cell_width = 10, cell_height = 10;  // [m]
  int draws = 400;
  std::uint64_t seed = 1;
};

/// Where the vehicle gets stuck most often: pieces around the weakest one that stop it at least half as often.
struct WeakestStretch {
  double begin = 0, end = 0;        // from the start of the way [m]
  double stuck = 0;                 // share of the draws that stop in it
  std::size_t outcome = 0;          // likeliest outcome there of the draws that stop, in contract().outcomes
  std::size_t piece = 0;            // the weakest piece
  std::size_t first = 0, last = 0;  // pieces of the stretch
};

struct DriveForecast {
  double chance = 1;                      // share of the draws that get through
  double error = 0;                       // its standard error
  double places = 0;                      // mean number of places where the vehicle gets stuck
  double not_sampled = 0;                 // chance that some soil on the way is what no trial answers for
  std::vector<double> stuck;              // [piece] share of the draws that it stops
  std::optional<WeakestStretch> weakest;  // none if no draw stops
};

/// Forecasts a drive over `pieces`, which follow each other. The same bits for any number of threads.
DriveForecast forecast_drive(const std::vector<DrivePiece>& pieces, const std::vector<DriveSoil>& soils,
                             const OutcomeModel& model, const DriveDoubt& doubt);

}  // namespace gonogo::map
