// The tables of one soil in the form that the page reads.
#pragma once
#include <vector>

#include "pipeline/map/evaluate/soil_response.h"
#include "pipeline/map/page/blob.h"
#include "pipeline/map/write/make_map.h"

namespace gonogo::map {

/// Name, samples, unknown variables, table sizes and measures of a soil.
Json page_soil(const MapRequest& request, const Soil& soil, const SoilResponse& response);

/// Appends the tables as blobs whose names end with `index`. P(go) is in steps of 1/65534 (65535: none). The
/// probability of each no-go reason is in steps of 1/255, speeds are in steps of 0.01 km/h (65535: none).
void add_soil_blobs(const SoilResponse& response, int index, std::vector<Blob>& blobs);

/// Appends P(go) of at most 16 points of the soil at slopes 2 degrees apart, [point][along][across], and returns
/// { stride, along, across, points: [point][variable] }. Variables without the slopes are in units of the sampled
/// ranges.
Json add_drive_table(const OutcomeModel& model, const SoilResponse& response, int index, std::vector<Blob>& blobs);

}  // namespace gonogo::map
