// The figure of a map: titles, legend with shares, curves and notes. pipeline/report draws it.
#pragma once
#include <filesystem>

#include "pipeline/map/evaluate/soil_table.h"
#include "pipeline/map/write/make_map.h"
#include "pipeline/map/write/picture.h"

namespace gonogo::map {

/// Writes the figure to `path` as PNG.
void write_map_figure(const MapRequest& request, const terrain::MapGrid& grid, const SoilTable& table,
                      const MapSummary& summary, const Picture& picture, const std::filesystem::path& path);

}  // namespace gonogo::map
