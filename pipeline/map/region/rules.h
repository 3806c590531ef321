// From outcome probabilities to the class and reason of a cell.
//
// P(go) is the probability of go or slow_go in a valid trial. Where a share u of what the soil may be was never
// sampled, P(go) lies between p (1 - u) and p (1 - u) + u, with p the P(go) of the sampled part. A cell gets a class
// only if the whole interval agrees on it, and is unknown otherwise; so it is never go on the strength of what was not
// simulated. What is too soft (pipeline/map/evaluate/soft_soil.h) counts like what was never sampled.
#pragma once
#include <filesystem>
#include <optional>
#include <vector>

#include "base/json/config.h"
#include "pipeline/campaign/study/contract.h"
#include "pipeline/map/region/spread.h"

namespace gonogo::map {

/// Which heading class, P(go) and reason of the map are about.
enum class HeadingMode { uphill, worst, best, set };

/// The section "map" of a study.
struct MapRules {
  HeadingMode heading_mode = HeadingMode::uphill;
  double heading = 0;                  // [deg clockwise from grid north], for HeadingMode::set
  double correlation_length = 100;     // [m] chances of passing are the same within, independent beyond; for routes
  double go = 0.8;                     // P(go) at or above: go, or slow_go when slow_go is the likelier outcome
  double no_go = 0.5;                  // P(go) below: no_go; between the two: slow_go
  double tolerated_outside_share = 0;  // shares not sampled up to this are taken to behave like the sampled part
  std::string moisture;  // "dry", "moist" or "wet" for the whole map; empty: the raster's, or every sample
  int draws = 16;        // points drawn from the ranges of a soil
  std::string fidelity = "fidelity of the trials not stated";  // printed under the title of the figure
  Spreads values;                                              // of the mission, such as payload; win over the region's
  std::filesystem::path cone_index_of;  // vehicle file whose cone index fine-grained soil must reach; empty: none
};

/// Throws InputError. Without a section the defaults hold.
MapRules read_map_rules(const std::optional<Config>& section);

/// "uphill", "worst", "best" or an azimuth in degrees, [0, 360); throws InputError, `where` first, for anything else.
void set_heading(MapRules& rules, const std::string& text, const std::string& where);
/// "uphill heading", "heading 45 degrees from grid north", ...
std::string heading_text(const MapRules& rules);

/// What the model says about a soil at one slope.
struct Prospect {
  std::vector<double> outcome;  // mean probabilities over the sampled part, [outcome count]; zeros when there is none
  double outside_share = 1;     // share of the soil's points that no trial answers for: not sampled, or too soft
  double soft_share = 0;        // share of them that are too soft

  double p_go() const;  // of the sampled part; not-a-number when there is none
};

struct CellClass {
  campaign::Verdict verdict = campaign::Verdict::unknown;
  campaign::Reason reason = campaign::Reason::outside_sampled;
};

/// soft_soil where at least half of what is not answered for is too soft, outside_sampled otherwise.
campaign::Reason reason_of_unknown(const Prospect& prospect);

/// `no_go` cells get their likeliest no_go reason, `unknown` ones reason_of_unknown(). Points that are too soft are
/// never tolerated.
CellClass classify(const Prospect& prospect, const MapRules& rules);

}  // namespace gonogo::map
