// Small vector files written with GDAL directly, for tests of the code that reads them.
#pragma once
#include <gdal_priv.h>
#include <ogr_spatialref.h>
#include <ogrsf_frmts.h>

#include <filesystem>
#include <stdexcept>
#include <utility>

namespace gonogo::test {

/// Squares of 8 m in UTM zone 10, one in each cell of the diagonal of a grid of 10 m cells from (500000, 4400000); with
/// `degrees` in WGS 84, for formats that know nothing else. Each has a width of 1 m more than the one before.
inline void make_squares(const std::filesystem::path& file, const char* format, int count = 40, bool degrees = false) {
  GDALAllRegister();
  GDALDataset* out =
      GetGDALDriverManager()->GetDriverByName(format)->Create(file.c_str(), 0, 0, 0, GDT_Unknown, nullptr);
  if (!out) throw std::runtime_error("cannot make " + file.string());
  OGRSpatialReference utm, crs;
  utm.importFromEPSG(32610);
  crs.importFromEPSG(degrees ? 4326 : 32610);
  for (OGRSpatialReference* system : {&utm, &crs}) system->SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  OGRCoordinateTransformation* turn = OGRCreateCoordinateTransformation(&utm, &crs);
  OGRLayer* layer = out->CreateLayer("squares", &crs, wkbPolygon, nullptr);
  OGRFieldDefn width("width", OFTReal);
  layer->CreateField(&width);
  for (int i = 0; i < count; ++i) {
    OGRLinearRing ring;
    const double x = 500001 + 10 * i, y = 4399999 - 10 * i;
    for (const auto& [dx, dy] : {std::pair{0, 0}, {8, 0}, {8, -8}, {0, -8}, {0, 0}}) ring.addPoint(x + dx, y + dy);
    OGRPolygon square;
    square.addRing(&ring);
    square.transform(turn);
    OGRFeature* feature = OGRFeature::CreateFeature(layer->GetLayerDefn());
    feature->SetField("width", 1.0 + i);
    feature->SetGeometry(&square);
    if (layer->CreateFeature(feature) != OGRERR_NONE) throw std::runtime_error("cannot make " + file.string());
    OGRFeature::DestroyFeature(feature);
  }
  OGRCoordinateTransformation::DestroyCT(turn);
  GDALClose(out);
}

}  // namespace gonogo::test
