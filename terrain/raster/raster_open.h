// Opens rasters, rejects unusable ones with one sentence each, and warps them to another grid while they are read. Only
// for the .cpp files of terrain/raster.
#pragma once
#include <ogr_spatialref.h>
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "terrain/raster/gdal_support.h"

namespace gonogo::terrain {

struct GeoTransform {
  double value[6];  // x = v0 + v1 column + v2 row, y = v3 + v4 column + v5 row
};

/// A dataset and its sources, which must outlive it; later ones may use earlier ones. The destructor closes the dataset
/// first, then the sources from the last one on.
struct OpenRaster {
  std::vector<DatasetHandle> sources;
  DatasetHandle dataset;
  std::string name;  // for messages

  OpenRaster() = default;
  OpenRaster(OpenRaster&&) = default;
  OpenRaster& operator=(OpenRaster&& other) {
    sources.swap(other.sources);
    dataset.swap(other.dataset);
    name.swap(other.name);
    return *this;
  }
  ~OpenRaster() {
    dataset.reset();
    while (!sources.empty()) sources.pop_back();
  }
};

/// Opens one file, or a mosaic of tiles; where tiles overlap the later one counts. Rows that run northward and columns
/// that run westward are mirrored.
OpenRaster open_raster(const RasterFiles& files);

/// A command that messages advise: `program`, the file as a shell takes it, `rest`. `name`: of the raster, see
/// OpenRaster. Inside of a .zip GDAL's name of the file counts; of several tiles the command names none.
std::string command_on(const std::string& program, GDALDataset& dataset, const std::string& name,
                       const std::string& rest);
const OGRSpatialReference& require_crs(GDALDataset& dataset, const std::string& name);
GeoTransform require_north_up(GDALDataset& dataset, const std::string& name);
/// Factor from the band's stated unit of height to metres.
double vertical_metres(GDALRasterBand& band, const std::string& name);
MapGrid describe_grid(int columns, int rows, const OGRSpatialReference& crs, const GeoTransform& t);

/// Throws InputError for a projected system whose cells are as small, and lie, as those in degrees do.
void require_metres(GDALDataset& dataset, const OGRSpatialReference& crs, const GeoTransform& t,
                    const std::string& name);

/// Throws InputError for complex values, for a colour table, for three or more bands, which are a picture, and for a
/// band of transparency that GDAL's mask does not count.
void require_heights(GDALDataset& dataset, const std::string& name);
/// Which of two bands is read; empty for one band.
std::string remark_on_bands(GDALDataset& dataset, const std::string& name);
/// Throws InputError for complex values and for bands of red, green and blue.
void require_one_value(GDALDataset& dataset, const std::string& name);

/// Factor from heights to metres: `told` ("m", "ft", "us-ft") wins, with a remark if the raster says something else;
/// then the band's unit or the vertical part of the coordinate system. Metres if nothing is said and the grid is not in
/// feet. Throws InputError for an unknown unit, for band and system that differ, and for a grid in feet whose heights
/// have no unit.
double height_unit(GDALDataset& dataset, const OGRSpatialReference& crs, const std::string& name,
                   const std::string& told, std::vector<std::string>& remarks);

/// Extent {west, south, east, north} of a raster in another coordinate system; empty when it has none there.
std::optional<std::array<double, 4>> extent_on(GDALDataset& dataset, const GeoTransform& t,
                                               const OGRSpatialReference& from, const OGRSpatialReference& to);

std::optional<std::array<double, 4>> extent_on(const MapGrid& grid, const OGRSpatialReference& from,
                                               const OGRSpatialReference& to);

/// Ground size of the cell in the middle [m]: {eastward, southward}; nothing when it has no place on the ground.
std::optional<std::array<double, 2>> middle_cell_size(GDALDataset& dataset, const GeoTransform& t,
                                                      const OGRSpatialReference& crs);

/// Grid that the elevation must be warped to; empty when its own grid serves. Throws InputError when neither is
/// possible, and when the metres of a wished system are more than 3 % off those of the ground, because it belongs to
/// another part of the globe.
std::optional<MapGrid> grid_for(const OpenRaster& raster, const OGRSpatialReference& crs, const GeoTransform& t,
                                const GridWish& wish);

/// `resampling`: a name of gdalwarp's -r.
void warp_to(OpenRaster& raster, const MapGrid& grid, const std::string& resampling);

}  // namespace gonogo::terrain
