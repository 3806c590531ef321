#include "terrain/raster/vector/read_vector.h"

#include <cpl_error.h>
#include <cpl_string.h>
#include <gdal_alg.h>
#include <ogrsf_frmts.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <optional>

#include "base/error.h"
#include "base/format.h"
#include "base/shell.h"
#include "terrain/raster/open_file.h"
#include "terrain/raster/vector/geojson.h"

namespace gonogo::terrain {
namespace fs = std::filesystem;

namespace {

std::uint32_t big_endian(const char* at) {
  std::uint32_t value = 0;
  for (int i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(at[i]);
  return value;
}

std::uint32_t little_endian(const char* at, int bytes) {
  std::uint32_t value = 0;
  for (int i = bytes; i-- > 0;) value = value << 8 | static_cast<unsigned char>(at[i]);
  return value;
}

/// The first bytes of a file beside `shp`, and its size; nothing where it is not there.
struct Head {
  std::array<char, 32> byte{};
  std::uint64_t size = 0;
};
std::optional<Head> head_of(fs::path file, const char* extension) {
  file.replace_extension(extension);
  std::ifstream in(file, std::ios::binary);
  Head head;
  if (!in.read(head.byte.data(), std::streamsize(head.byte.size()))) return std::nullopt;
  head.size = fs::file_size(file);
  return head;
}

/// Rows of a .dbf that are marked as deleted, which readers pass over: their first byte is '*' (dBASE III).
GIntBig deleted_rows(fs::path dbf) {
  std::ifstream in(dbf.replace_extension("dbf"), std::ios::binary);
  std::array<char, 32> head{};
  if (!in.read(head.data(), std::streamsize(head.size()))) return 0;
  const std::uint32_t rows = little_endian(head.data() + 4, 4), begin = little_endian(head.data() + 8, 2),
                      length = little_endian(head.data() + 10, 2);
  std::vector<char> row(length);
  GIntBig deleted = 0;
  in.seekg(begin);
  for (std::uint32_t r = 0; length > 0 && r < rows && in.read(row.data(), length); ++r) deleted += row[0] == '*';
  return deleted;
}

/// Compares the files of a Shapefile with their headers (ESRI Shapefile Technical Description, 1998; dBASE III): GDAL
/// reads a cut one up to the cut.
void require_whole_shapefile(const fs::path& shp) {
  const auto refuse = [&](const std::string& why) {
    throw InputError(shp.string() + ": " + why + "; fetch .shp, .shx and .dbf again");
  };
  std::optional<std::uint64_t> shapes, rows;
  for (const char* extension : {"shp", "shx"})
    if (const auto head = head_of(shp, extension)) {
      const std::uint64_t length = 2ull * big_endian(head->byte.data() + 24);
      if (head->size < length)
        refuse(std::string("its .") + extension + " is cut off: it has " + std::to_string(head->size) + " bytes of " +
               std::to_string(length));
      if (std::string(extension) == "shx") shapes = length < 100 ? 0 : (length - 100) / 8;
    }
  if (const auto head = head_of(shp, "dbf")) {
    rows = little_endian(head->byte.data() + 4, 4);
    const std::uint64_t length =
        little_endian(head->byte.data() + 8, 2) + *rows * little_endian(head->byte.data() + 10, 2);
    if (head->size < length)
      refuse("its .dbf is cut off: it has " + std::to_string(head->size) + " bytes of " + std::to_string(length));
  }
  if (shapes && rows && *shapes != *rows)
    refuse("its .shx has " + std::to_string(*shapes) + " shapes and its .dbf " + std::to_string(*rows) + " rows");
}

using Shape = std::unique_ptr<OGRGeometry>;

bool is_line(const OGRGeometry& g) {
  const OGRwkbGeometryType type = wkbFlatten(g.getGeometryType());
  return type == wkbLineString || type == wkbMultiLineString;
}

bool is_area(const OGRGeometry& g) {
  const OGRwkbGeometryType type = wkbFlatten(g.getGeometryType());
  return type == wkbPolygon || type == wkbMultiPolygon;
}

/// Angle of a chord in place of a curve [deg]: it lies 4e-5 radii inside.
constexpr double kChord = 1;

/// Lines and polygons that a shape consists of. Others, such as points, are handed on as they are.
void add_parts(const OGRGeometry& shape, std::vector<Shape>& parts) {
  if (shape.IsEmpty()) return;
  const OGRwkbGeometryType type = wkbFlatten(shape.getGeometryType());
  if (type == wkbGeometryCollection) {
    for (const OGRGeometry* member : *shape.toGeometryCollection()) add_parts(*member, parts);
  } else if (OGR_GT_IsSubClassOf(type, wkbPolyhedralSurface) || type == wkbTriangle) {
    parts.emplace_back(OGRGeometryFactory::forceToMultiPolygon(shape.clone()));
  } else {
    parts.emplace_back(shape.getLinearGeometry(kChord));
  }
}

/// Whether all coordinates are numbers of a size that a map can have: GDAL marks the cells of a line step by step, also
/// far from the map, and would not come to an end. NaN, which GeoJSON may hold, would take corners away.
class OnGlobe : public OGRDefaultConstGeometryVisitor {
 public:
  explicit OnGlobe(double farthest) : farthest_(farthest) {}
  using OGRDefaultConstGeometryVisitor::visit;
  void visit(const OGRPoint* point) override {
    holds = holds && std::abs(point->getX()) < farthest_ && std::abs(point->getY()) < farthest_;
  }
  bool holds = true;

 private:
  double farthest_;  // [units]
};

bool is_on_globe(const OGRGeometry& shape, const OGRSpatialReference& crs) {
  OnGlobe all(crs.IsGeographic() ? 1000 : 1e8);  // the Earth is 4e7 m around
  shape.accept(&all);
  return all.holds;
}

/// Brings a shape to the map's system. What is straight in one system is not in another, so that long edges are
/// divided: an edge of 2 km along a parallel lies within 10 cm of its chord up to 80 degrees of latitude. False where
/// it has no place there.
bool carry_over(OGRGeometry& shape, const OGRSpatialReference& from, OGRCoordinateTransformation* turn,
                const OGRSpatialReference& to) {
  constexpr double kLongestEdge = 2000;  // [m]
  constexpr double kDegree = 111320;     // [m]
  if (!is_on_globe(shape, from)) return false;
  if (!turn) return true;
  shape.segmentize(kLongestEdge / (from.IsGeographic() ? kDegree : from.GetLinearUnits()));
  return shape.transform(turn) == OGRERR_NONE && is_on_globe(shape, to);
}

/// Why carry_over() finds no place, and what to do.
std::string why_nowhere(const OGRGeometry& shape, const OGRSpatialReference& from, const fs::path& file) {
  OGREnvelope box;
  shape.getEnvelope(&box);
  const bool are_degrees = std::max(std::fabs(box.MinX), std::fabs(box.MaxX)) <= 360 &&
                           std::max(std::fabs(box.MinY), std::fabs(box.MaxY)) <= 90;
  if (!from.IsGeographic() || are_degrees) return "has no place in the map's coordinate system";
  const std::string corner = number_text(box.MinX, 9) + ", " + number_text(box.MinY, 9);
  if (std::fabs(box.MinY) <= 360 && std::fabs(box.MaxY) <= 360)
    return "its corner " + corner +
           " is no longitude and latitude; if latitudes stand first, swap them with: ogr2ogr -ct "
           "'+proj=axisswap +order=2,1' swapped.gpkg " +
           shell_word(file.string());
  return "its corner " + corner +
         " is no longitude and latitude, in which its file is said to be, as GeoJSON is unless "
         "it says otherwise; name the system that it is in with: ogr2ogr -a_srs EPSG:<code> with_system.gpkg " +
         shell_word(file.string());
}

class VectorFile {
 public:
  VectorFile(const fs::path& file, const MapGrid& grid) : file_(file), crs_(system_of(grid)), grid_(grid) {
    dataset_ = open_file(file, FileKind::vector);
    is_shapefile_ = EQUAL(dataset_->GetDriverName(), "ESRI Shapefile");
    if (is_shapefile_ && fs::is_regular_file(file) && !EQUAL(file.extension().c_str(), ".zip")) {
      require_whole_shapefile(file);
      deleted_ = deleted_rows(file);
    }
  }
  /// Calls take(feature, parts) for every feature of the layers of this name, its lines and polygons in the grid's
  /// system; not for empty ones. No name: all layers. Throws InputError where there is no such layer, and where reading
  /// fails anywhere.
  template <class Take>
  void read(const std::string& name, const Take& take) {
    bool found = false;
    for (OGRLayer* layer : dataset_->GetLayers()) {
      if (!name.empty() && name != layer->GetName()) continue;
      found = true;
      if (layer->GetGeomType() != wkbNone) read_layer(*layer, take);
    }
    if (without_shape_ > 0) require_all_shapes();
    if (!found) throw InputError(file_.string() + ": has no layer \"" + name + "\"; ogrinfo lists its layers");
  }
  std::vector<std::string> remarks;

 private:
  template <class Take>
  void read_layer(OGRLayer& layer, const Take& take) {
    const OGRSpatialReference* from = layer.GetSpatialRef();
    if (!from) throw InputError(file_.string() + ": names no coordinate system; give one, for example as GeoPackage");
    const std::string shift = check_shift(*from, crs_, file_.string(), std::sqrt(grid_.cell_area_m2()));
    if (!shift.empty() && remarks.empty()) remarks.push_back(shift);
    Transformation turn;
    if (!from->IsSame(&crs_)) {
      turn.reset(OGRCreateCoordinateTransformation(from, &crs_));
      if (!turn) throw InputError(file_.string() + ": no way is known from its coordinate system to the map's");
    }
    const GdalCall call;  // its message is the first fault of reading
    GIntBig count = 0;
    for (const auto& feature : layer) {
      require_no_failure(call);
      ++count;
      std::vector<Shape> parts;
      if (const OGRGeometry* shape = feature->GetGeometryRef(); shape && !shape->IsEmpty()) add_parts(*shape, parts);
      ++(parts.empty() ? without_shape_ : with_shape_);
      for (const Shape& part : parts)
        if (!carry_over(*part, *from, turn.get(), crs_))
          throw InputError(file_.string() + ": feature " + std::to_string(feature->GetFID()) + ": " +
                           why_nowhere(*feature->GetGeometryRef(), *from, file_));
      if (!parts.empty()) take(*feature, std::move(parts));
      CPLErrorReset();
    }
    require_no_failure(call);
    // A GeoPackage counts its features in a table that other programs leave stale.
    const GIntBig told = EQUAL(dataset_->GetDriverName(), "GPKG") ? -1 : layer.GetFeatureCount(FALSE);
    if (told > count + deleted_)
      throw InputError(file_.string() + ": has " + std::to_string(told) + " features, and reading ended after " +
                       std::to_string(count) + "; the file is damaged or incomplete, fetch it again");
  }
  /// Of GeoJSON, some of whose features came without a shape: whether they state none.
  void require_all_shapes() const {
    const std::string format = dataset_->GetDriverName();
    if (format.rfind("GeoJSON", 0) != 0) return;
    GByte* bytes = nullptr;
    vsi_l_offset size = 0;
    if (!VSIIngestFile(nullptr, dataset_->GetDescription(), &bytes, &size, -1)) return;
    const std::unique_ptr<GByte, decltype(&VSIFree)> owner(bytes, &VSIFree);
    const std::uint64_t stated =
        stated_shapes(std::string(reinterpret_cast<const char*>(bytes), size), format == "GeoJSONSeq", file_.string());
    if (stated > with_shape_)
      throw InputError(file_.string() + ": " + std::to_string(stated) + " features state a shape, and only " +
                       std::to_string(with_shape_) +
                       " of them can be read; correct type and coordinates of the others");
  }
  void require_no_failure(const GdalCall& call) const {
    if (call.failed())
      throw InputError(file_.string() + ": reading its features failed (" + call.message() +
                       "); the file is damaged or incomplete, fetch it again");
  }

  fs::path file_;
  OGRSpatialReference crs_;
  MapGrid grid_;
  DatasetHandle dataset_;
  bool is_shapefile_ = false;
  GIntBig deleted_ = 0;                               // rows of a Shapefile
  std::uint64_t with_shape_ = 0, without_shape_ = 0;  // features so far
};

}  // namespace

std::vector<std::uint8_t> cells_under(const fs::path& file, const MapGrid& grid) {
  const GdalCall call;
  std::vector<Shape> polygons;
  VectorFile(file, grid).read("", [&](const OGRFeature&, std::vector<Shape> parts) {
    for (Shape& shape : parts) {
      if (!is_area(*shape))
        throw InputError(file.string() + ": holds a shape that is no polygon (" +
                         OGRGeometryTypeToName(shape->getGeometryType()) + "); draw the area to avoid as a polygon");
      polygons.push_back(std::move(shape));
    }
  });
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

}  // namespace

struct ShapeCells::State {
  struct Marked {
    Shape outline;
    OGREnvelope box;
    float value = 0;
    int rank = 0;
  };
  MapGrid grid;
  std::vector<Marked> shapes;
  std::vector<std::string> remarks;
};

ShapeCells::ShapeCells(const MapGrid& grid) : state_(std::make_unique<State>()) { state_->grid = grid; }
ShapeCells::ShapeCells(ShapeCells&&) noexcept = default;
ShapeCells::~ShapeCells() = default;

void ShapeCells::add(const fs::path& file, const std::string& layer_name,
                     const std::function<ShapeMark(const FeatureNumbers&)>& mark) {
  const GdalCall call;
  const MapGrid& grid = state_->grid;
  const double east = grid.east(), south = grid.south();
  const double per_metre = grid.cell_width / grid.cell_width_m();
  bool touches = false;
  VectorFile vector(file, grid);
  vector.read(layer_name, [&](const OGRFeature& feature, std::vector<Shape> parts) {
    for (const Shape& shape : parts)
      if (!is_line(*shape) && !is_area(*shape))
        throw InputError(file.string() + ": holds a shape that is neither line nor polygon (" +
                         OGRGeometryTypeToName(shape->getGeometryType()) + "); draw it as one of them");
    const ShapeMark marked = mark([&](const std::string& attribute) { return number_of(feature, attribute, file); });
    for (Shape& shape : parts) {
      if (is_line(*shape) && marked.width * per_metre > grid.cell_width)
        if (OGRGeometry* wide = shape->Buffer(0.5 * marked.width * per_metre)) shape.reset(wide);
      State::Marked s{std::move(shape), {}, marked.value, marked.rank};
      s.outline->getEnvelope(&s.box);
      const bool here = s.box.MinX < east && s.box.MaxX > grid.west && s.box.MinY < grid.north && s.box.MaxY > south;
      touches = touches || here;
      if (here && marked.value != 0) state_->shapes.push_back(std::move(s));
    }
  });
  state_->remarks.insert(state_->remarks.end(), vector.remarks.begin(), vector.remarks.end());
  std::stable_sort(state_->shapes.begin(), state_->shapes.end(),
                   [](const auto& a, const auto& b) { return a.rank < b.rank; });
  if (!touches) throw InputError(file.string() + ": no shape of it touches the map; check its coordinate system");
}

const std::vector<std::string>& ShapeCells::remarks() const { return state_->remarks; }

Tile ShapeCells::read(Window window) const {
  const GdalCall call;
  const MapGrid& grid = state_->grid;
  const double west = grid.west + window.column * grid.cell_width, north = grid.north - window.row * grid.cell_height;
  const double east = west + window.columns * grid.cell_width, south = north - window.rows * grid.cell_height;
  std::vector<OGRGeometryH> shapes;
  std::vector<double> value;
  for (const State::Marked& s : state_->shapes) {
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
