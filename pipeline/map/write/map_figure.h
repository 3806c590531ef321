// What the figure of a map says: titles, legend shares, curves and notes, put together for pipeline/report.
#pragma once
#include <filesystem>

#include "pipeline/map/evaluate/soil_table.h"
#include "pipeline/map/write/make_map.h"
#include "pipeline/map/write/picture.h"

namespace gonogo::map {

void write_map_figure(const MapRequest& request, const terrain::MapGrid& grid, const SoilTable& table,
                      const MapSummary& summary, const Picture& picture, const std::filesystem::path& path);

}  // namespace gonogo::map
