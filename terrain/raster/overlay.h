// A class layer as a picture with its place on the globe, for programs that are not GIS.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "terrain/raster/geotiff.h"
#include "terrain/raster/globe.h"

namespace gonogo::terrain {

/// Files written, or why there are none.
struct OverlayAnswer {
  std::vector<std::filesystem::path> files;  // the KML, then one PNG for each piece of the place
  std::string why_not;                       // without a full stop
};

/// Writes a class layer, warped to longitude and latitude, as PNGs with transparent nodata, at most `longest` pixels a
/// side; and the KML that places them on the globe, with a hint for globes of the Moon and Mars. The second piece of a
/// place is the file `png` with "_2" behind its stem. Texts are escaped. Without a way to warp the layer nothing is
/// written. Throws DeviceError when writing fails.
OverlayAnswer write_overlay(const std::filesystem::path& kml, const std::filesystem::path& png,
                            const std::filesystem::path& layer, const GlobePlace& place, const std::string& title,
                            const std::string& description, const std::vector<LegendEntry>& legend, int longest = 2048);

/// Escapes text for XML. Control characters, which XML does not allow, become spaces.
std::string xml_escaped(const std::string& text);

}  // namespace gonogo::terrain
