// The tables of one soil as the page gets them.
#pragma once
#include <vector>

#include "pipeline/map/evaluate/soil_response.h"
#include "pipeline/map/page/blob.h"
#include "pipeline/map/write/make_map.h"

namespace gonogo::map {

/// Name, samples, what is not known, sizes of the tables, measures.
Json page_soil(const MapRequest& request, const Soil& soil, const SoilResponse& response);

/// Probabilities in steps of 1/65534 (65535: none), of single no-go reasons in steps of 1/255; `index` ends the names.
void add_soil_blobs(const SoilResponse& response, int index, std::vector<Blob>& blobs);

}  // namespace gonogo::map
