// Work of commands that needs LibTorch or GDAL. Each is held by one of the programs (elsewhere.h); the tables of
// options are the same in all of them.
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/app/run/plan.h"
#include "pipeline/app/work/result.h"
#include "pipeline/campaign/engine/study_campaign.h"
#include "pipeline/learn/training/capacity.h"
#include "pipeline/map/soil_grids/make_region.h"
#include "pipeline/map/write/compare_maps.h"
#include "pipeline/map/write/map_request.h"

namespace gonogo::app {

struct DesignOptions {
  std::filesystem::path study;
  bool csv = false;  // the table of points alone
};

struct RouteOptions {
  map::MapFiles files;
  std::string from, to;          // "easting,northing"; empty: not asked
  std::vector<std::string> via;  // places between
  std::string avoid, departure;  // polygons; time of GPX tracks, empty: kNoDate
  bool eight_directions = false;
  double turning = 0;                           // metres that cost as much as a turn by 90 degrees
  std::string costmap, grid_map;                // files; empty: not written
  std::vector<std::string> costs{"safest"};     // names; the first one also bands and reaches
  std::string out, reach, isochrones, regions;  // files; empty: not written
  double interval = 0;                          // width of a band, in the unit of the first cost; 0: a round one
};

struct ViewOptions {
  std::string folder, address = "127.0.0.1";
  std::uint16_t port = 8470;  // 0: any free one
};

struct TrainOptions {
  std::vector<std::filesystem::path> datasets;  // each of another fidelity
  std::filesystem::path study, out;             // study: empty for defaults
  std::optional<std::uint64_t> seed;            // nothing: the study's, or 1
  int members = 0;                              // models on reweighted trials
  std::size_t hold_out = 0;                     // trials
};

struct EvaluateOptions {
  std::filesystem::path model, dataset, out, rows;  // dataset, out, rows: empty for none
};

struct LearningCurveOptions {
  std::vector<std::filesystem::path> datasets;         // each of another fidelity
  std::filesystem::path study, out;                    // study: empty for defaults
  std::optional<std::uint64_t> seed;                   // nothing: the study's, or 1
  std::vector<std::size_t> trials = {100, 300, 1000};  // numbers to train on
  std::size_t hold_out = 1000, subsets = 5;
  bool active = false;
};

struct CapacityOptions {
  std::filesystem::path study, out;  // empty: defaults, no file
  learn::CapacityRequest request;    // without its sections
};

struct ActiveOptions {
  std::filesystem::path study, folder;
  campaign::ComputeRequest compute;
  std::uint64_t seeds = 64, batch = 32, max_points = 1000;
  double confidence = 0.95, space_filling = 0.25;
};

// With GDAL: in gonogo-map.
void region_design_work(const Globals& globals, const DesignOptions& options);
void map_work(const Globals& globals, const map::MapFiles& files);
void region_make_work(const Globals& globals, const map::RegionMakeRequest& request);
void route_work(const Globals& globals, const RouteOptions& options);
void compare_work(const Globals& globals, const map::CompareRequest& request);
void view_work(const Globals& globals, const ViewOptions& options);

// With LibTorch: in gonogo-learn.
void train_work(const Globals& globals, const TrainOptions& options);
void evaluate_work(const Globals& globals, const EvaluateOptions& options);
void learning_curve_work(const Globals& globals, const LearningCurveOptions& options);
void capacity_work(const Globals& globals, const CapacityOptions& options);
void active_work(const Globals& globals, const ActiveOptions& options);

// With both: in gonogo-learn.
void run_work(const Globals& globals, const RunRequest& request);

}  // namespace gonogo::app
