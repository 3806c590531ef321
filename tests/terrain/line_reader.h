// Lines and polygons of a vector file read back with GDAL directly.
#pragma once
#include <gdal_priv.h>
#include <ogrsf_frmts.h>

#include <filesystem>
#include <map>
#include <memory>
#include <stdexcept>

namespace gonogo::test {

struct ReadLines {
  long long count = 0;
  double west = 0;
  bool degrees = false;
};

/// The first layer that holds features other than points, which are waypoints of GPX.
inline ReadLines read_lines(const std::filesystem::path& path) {
  GDALAllRegister();
  std::unique_ptr<GDALDataset> file(GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR));
  if (!file) throw std::runtime_error(path.string() + " cannot be opened");
  for (int l = 0; l < file->GetLayerCount(); ++l) {
    OGRLayer& layer = *file->GetLayer(l);
    if (layer.GetFeatureCount() == 0 || wkbFlatten(layer.GetGeomType()) == wkbPoint) continue;
    OGREnvelope box;
    if (layer.GetExtent(&box) != OGRERR_NONE) throw std::runtime_error(path.string() + " has no extent");
    return {layer.GetFeatureCount(), box.MinX, bool(layer.GetSpatialRef()->IsGeographic())};
  }
  return {};
}

/// Sum of area_km2 by code of a layer of polygons.
inline std::map<int, double> areas_by_code(const std::filesystem::path& path, const char* layer) {
  GDALAllRegister();
  std::unique_ptr<GDALDataset> file(GDALDataset::Open(path.c_str(), GDAL_OF_VECTOR));
  if (!file || !file->GetLayerByName(layer)) throw std::runtime_error(path.string() + " has no layer " + layer);
  std::map<int, double> area;
  for (const auto& feature : file->GetLayerByName(layer))
    area[feature->GetFieldAsInteger("code")] += feature->GetFieldAsDouble("area_km2");
  return area;
}

}  // namespace gonogo::test
