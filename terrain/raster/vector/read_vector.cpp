#include "terrain/raster/vector/read_vector.h"

#include <cpl_string.h>
#include <gdal_alg.h>
#include <ogrsf_frmts.h>
#include <algorithm>

#include "base/error.h"
#include "terrain/raster/gdal_support.h"

namespace gonogo::terrain {
namespace fs = std::filesystem;

namespace {

/// `shapes`: what the file is read as, for the message.
DatasetHandle open_vector(const fs::path& file, const GdalCall& call, const std::string& shapes) {
  std::error_code ec;
  if (!fs::exists(file, ec)) throw InputError(file.string() + ": no such file; check the path");
  DatasetHandle dataset(GDALDataset::Open(file.c_str(), GDAL_OF_VECTOR | GDAL_OF_READONLY));
  if (!dataset)
    throw InputError(file.string() + ": cannot be read as " + shapes + " (" + call.message() +
                     "); give a vector format that ogrinfo opens, for example GeoJSON");
  return dataset;
}

/// Polygons of a layer in the grid's system.
void take_polygons(OGRLayer& layer, const OGRSpatialReference& grid, const fs::path& file,
                   std::vector<std::unique_ptr<OGRGeometry>>& polygons) {
  const OGRSpatialReference* from = layer.GetSpatialRef();
  if (!from) throw InputError(file.string() + ": names no coordinate system; give one, for example as GeoPackage");
  const Transformation turn(OGRCreateCoordinateTransformation(from, &grid));
  if (!turn) throw InputError(file.string() + ": no way is known from its coordinate system to the map's");
  for (const auto& feature : layer) {
    if (!feature->GetGeometryRef()) continue;
    std::unique_ptr<OGRGeometry> shape(feature->GetGeometryRef()->clone());
    const OGRwkbGeometryType type = wkbFlatten(shape->getGeometryType());
    if (type != wkbPolygon && type != wkbMultiPolygon)
      throw InputError(file.string() + ": holds a shape that is no polygon (" + OGRGeometryTypeToName(type) +
                       "); draw the area to avoid as a polygon");
    if (shape->transform(turn.get()) != OGRERR_NONE)
      throw InputError(file.string() + ": a polygon has no place in the map's coordinate system");
    polygons.push_back(std::move(shape));
  }
}

}  // namespace

std::vector<std::uint8_t> cells_under(const fs::path& file, const MapGrid& grid) {
  const GdalCall call;
  const DatasetHandle vector = open_vector(file, call, "polygons");
  const OGRSpatialReference crs = system_of(grid);
  std::vector<std::unique_ptr<OGRGeometry>> polygons;
  for (OGRLayer* layer : vector->GetLayers()) take_polygons(*layer, crs, file, polygons);
  std::vector<std::uint8_t> cells(std::size_t(grid.columns) * std::size_t(grid.rows), 0);
  DatasetHandle raster(
      GetGDALDriverManager()->GetDriverByName("MEM")->Create("", grid.columns, grid.rows, 1, GDT_Byte, nullptr));
  double transform[6] = {grid.west, grid.cell_width, 0, grid.north, 0, -grid.cell_height};
  raster->SetGeoTransform(transform);
  std::vector<OGRGeometryH> shapes;
  for (const auto& polygon : polygons) shapes.push_back(OGRGeometry::ToHandle(polygon.get()));
  int band = 1;
  const std::vector<double> burn(shapes.size(), 1.0);
  CPLStringList options;
  options.SetNameValue("ALL_TOUCHED", "TRUE");
  if (!shapes.empty() &&
      (GDALRasterizeGeometries(raster.get(), 1, &band, int(shapes.size()), shapes.data(), nullptr, nullptr, burn.data(),
                               options.List(), nullptr, nullptr) != CE_None ||
       raster->GetRasterBand(1)->RasterIO(GF_Read, 0, 0, grid.columns, grid.rows, cells.data(), grid.columns, grid.rows,
                                          GDT_Byte, 0, 0, nullptr) != CE_None))
    throw DeviceError(file.string() + ": its polygons cannot be put on the grid (" + call.message() + ")");
  if (std::find(cells.begin(), cells.end(), 1) == cells.end())
    throw InputError(file.string() + ": no polygon of it touches the map; check its coordinate system");
  return cells;
}

namespace {

double number_of(const OGRFeature& feature, const std::string& attribute, const fs::path& file) {
  const std::string where = file.string() + ": feature " + std::to_string(feature.GetFID()) + ": " + attribute;
  const int field = feature.GetFieldIndex(attribute.c_str());
  if (field < 0) throw InputError(where + ": no such attribute; name one that every feature has, or give a number");
  const OGRFieldType type = feature.GetFieldDefnRef(field)->GetType();
  const bool is_number = type == OFTReal || type == OFTInteger || type == OFTInteger64;
  if (!is_number || !feature.IsFieldSetAndNotNull(field))
    throw InputError(where + ": is \"" + feature.GetFieldAsString(field) +
                     "\", and a number is needed; complete the file");
  return feature.GetFieldAsDouble(field);
}

bool is_line(const OGRGeometry& g) {
  const OGRwkbGeometryType type = wkbFlatten(g.getGeometryType());
  return type == wkbLineString || type == wkbMultiLineString;
}

bool is_area(const OGRGeometry& g) {
  const OGRwkbGeometryType type = wkbFlatten(g.getGeometryType());
  return type == wkbPolygon || type == wkbMultiPolygon;
}

}  // namespace

struct ShapeCells::State {
  struct Shape {
    std::unique_ptr<OGRGeometry> outline;
    OGREnvelope box;
    float value = 0;
    int rank = 0;
  };
  MapGrid grid;
  std::vector<Shape> shapes;
};

ShapeCells::ShapeCells(const MapGrid& grid) : state_(std::make_unique<State>()) { state_->grid = grid; }
ShapeCells::ShapeCells(ShapeCells&&) noexcept = default;
ShapeCells::~ShapeCells() = default;

void ShapeCells::add(const fs::path& file, const std::string& layer_name,
                     const std::function<ShapeMark(const FeatureNumbers&)>& mark) {
  const GdalCall call;
  const DatasetHandle vector = open_vector(file, call, "lines or polygons");
  const MapGrid& grid = state_->grid;
  const OGRSpatialReference crs = system_of(grid);
  const double east = grid.east(), south = grid.south();
  const double per_metre = grid.cell_width / grid.cell_width_m();
  bool found = false, touches = false;
  for (OGRLayer* layer : vector->GetLayers()) {
    if (!layer_name.empty() && layer_name != layer->GetName()) continue;
    found = true;
    const OGRSpatialReference* from = layer->GetSpatialRef();
    if (!from) throw InputError(file.string() + ": names no coordinate system; give one, for example as GeoPackage");
    const Transformation turn(OGRCreateCoordinateTransformation(from, &crs));
    if (!turn) throw InputError(file.string() + ": no way is known from its coordinate system to the map's");
    for (const auto& feature : *layer) {
      if (!feature->GetGeometryRef()) continue;
      std::unique_ptr<OGRGeometry> shape(feature->GetGeometryRef()->clone());
      if (!is_line(*shape) && !is_area(*shape))
        throw InputError(file.string() + ": holds a shape that is neither line nor polygon (" +
                         OGRGeometryTypeToName(shape->getGeometryType()) + "); draw it as one of them");
      if (shape->transform(turn.get()) != OGRERR_NONE)
        throw InputError(file.string() + ": a shape has no place in the map's coordinate system");
      const ShapeMark marked = mark([&](const std::string& attribute) { return number_of(*feature, attribute, file); });
      if (is_line(*shape) && marked.width * per_metre > grid.cell_width)
        if (OGRGeometry* wide = shape->Buffer(0.5 * marked.width * per_metre)) shape.reset(wide);
      State::Shape s{std::move(shape), {}, marked.value, marked.rank};
      s.outline->getEnvelope(&s.box);
      const bool here = s.box.MinX < east && s.box.MaxX > grid.west && s.box.MinY < grid.north && s.box.MaxY > south;
      touches = touches || here;
      if (here && marked.value != 0) state_->shapes.push_back(std::move(s));
    }
  }
  std::stable_sort(state_->shapes.begin(), state_->shapes.end(),
                   [](const auto& a, const auto& b) { return a.rank < b.rank; });
  if (!found) throw InputError(file.string() + ": has no layer \"" + layer_name + "\"; ogrinfo lists its layers");
  if (!touches) throw InputError(file.string() + ": no shape of it touches the map; check its coordinate system");
}

Tile ShapeCells::read(Window window) const {
  const GdalCall call;
  const MapGrid& grid = state_->grid;
  const double west = grid.west + window.column * grid.cell_width, north = grid.north - window.row * grid.cell_height;
  const double east = west + window.columns * grid.cell_width, south = north - window.rows * grid.cell_height;
  std::vector<OGRGeometryH> shapes;
  std::vector<double> value;
  for (const State::Shape& s : state_->shapes) {
    if (s.box.MinX >= east || s.box.MaxX <= west || s.box.MinY >= north || s.box.MaxY <= south) continue;
    shapes.push_back(OGRGeometry::ToHandle(s.outline.get()));
    value.push_back(s.value);
  }
  Tile tile(window.columns, window.rows, 0);
  if (shapes.empty()) return tile;
  DatasetHandle raster(
      GetGDALDriverManager()->GetDriverByName("MEM")->Create("", window.columns, window.rows, 1, GDT_Float32, nullptr));
  double transform[6] = {west, grid.cell_width, 0, north, 0, -grid.cell_height};
  raster->SetGeoTransform(transform);
  int band = 1;
  CPLStringList options;
  options.SetNameValue("ALL_TOUCHED", "TRUE");
  if (GDALRasterizeGeometries(raster.get(), 1, &band, int(shapes.size()), shapes.data(), nullptr, nullptr, value.data(),
                              options.List(), nullptr, nullptr) != CE_None ||
      raster->GetRasterBand(1)->RasterIO(GF_Read, 0, 0, window.columns, window.rows, tile.value.data(), window.columns,
                                         window.rows, GDT_Float32, 0, 0, nullptr) != CE_None)
    throw DeviceError("shapes cannot be put on the grid (" + call.message() + ")");
  return tile;
}

}  // namespace gonogo::terrain
