#include "terrain/raster/heights.h"

#include <cmath>
#include <optional>

#include "base/error.h"
#include "base/line.h"

namespace gonogo::terrain {
namespace {

constexpr double kFoot = 0.3048, kSurveyFoot = 1200.0 / 3937.0;  // [m]

void refuse_complex(GDALDataset& dataset, const std::string& name) {
  const GDALDataType type = dataset.GetRasterBand(1)->GetRasterDataType();
  if (GDALDataTypeIsComplex(type))
    throw InputError(name + ": holds complex values (" + GDALGetDataTypeName(type) +
                     "), of which nobody said what counts; give a raster of real values");
}

/// Nothing when the coordinate system has no vertical part.
std::optional<double> unit_of_system(const OGRSpatialReference& crs) {
  if (!crs.IsVertical()) return std::nullopt;
  return crs.GetTargetLinearUnits("VERT_CS", nullptr);
}

std::string unit_name(double metres) {
  if (metres == 1) return "metres";
  return std::abs(metres / kFoot - 1) < 1e-3 ? "feet" : line("units of %g m", metres);
}

/// International and survey foot count as the same here; the difference is 2e-6.
bool differ(double a, double b) { return std::abs(a / b - 1) > 1e-3; }

/// With a scale of 0 every cell would have one value.
void refuse_scale(GDALDataset& dataset, const std::string& name) {
  const double scale = dataset.GetRasterBand(1)->GetScale(), offset = dataset.GetRasterBand(1)->GetOffset();
  if (scale != 0 && std::isfinite(scale) && std::isfinite(offset)) return;
  throw InputError(
      line("%s: names a scale of %g and an offset of %g for its values, and a scale other than 0 is needed; "
           "set them with gdal_edit.py -scale -offset",
           name.c_str(), scale, offset));
}

}  // namespace

void require_one_value(GDALDataset& dataset, const std::string& name) {
  refuse_complex(dataset, name);
  refuse_scale(dataset, name);
  if (dataset.GetRasterCount() >= 3 && dataset.GetRasterBand(1)->GetColorInterpretation() == GCI_RedBand)
    throw InputError(
        name +
        ": is a picture with bands of red, green and blue, whose colours are no values; give the raster that it shows");
}

void require_heights(GDALDataset& dataset, const std::string& name) {
  refuse_complex(dataset, name);
  refuse_scale(dataset, name);
  if (dataset.GetRasterCount() > 2)
    throw InputError(
        line("%s: has %d bands, and an elevation raster has one; a picture in colour tells no heights. If one "
             "band holds them, take it out with: gdal_translate -b 1 ",
             name.c_str(), dataset.GetRasterCount()) +
        name + " heights.tif");
  if (dataset.GetRasterBand(1)->GetColorTable())
    throw InputError(name +
                     ": has a colour table, so it holds classes or a picture, not heights; give an elevation raster");
}

double height_unit(GDALDataset& dataset, const OGRSpatialReference& crs, const std::string& name,
                   const std::string& told, std::vector<std::string>& remarks) {
  GDALRasterBand& band = *dataset.GetRasterBand(1);
  const std::optional<double> of_system = unit_of_system(crs);
  std::optional<double> of_band;
  if (!std::string(band.GetUnitType()).empty()) of_band = vertical_metres(band, name);
  const std::optional<double> said = of_band ? of_band : of_system;
  if (!told.empty()) {
    const double metres = told == "m" ? 1 : told == "ft" ? kFoot : kSurveyFoot;
    if (said && differ(*said, metres))
      remarks.push_back(name + ": heights are taken as " + unit_name(metres) + ", as was asked, though it says " +
                        unit_name(*said));
    return metres;
  }
  const std::string remedy =
      "; say which holds with \"unit\" of the elevation in the region, or --height-unit: m, ft or us-ft";
  if (of_band && of_system && differ(*of_band, *of_system))
    throw InputError(name + ": its band says that heights are in " + unit_name(*of_band) +
                     ", and its coordinate system that they are in " + unit_name(*of_system) + remedy);
  if (!said && crs.IsProjected() && differ(crs.GetLinearUnits(), 1))
    throw InputError(name + ": its grid is in " + unit_name(crs.GetLinearUnits()) +
                     ", and nothing says whether its heights are in metres or feet" + remedy);
  return said.value_or(1);
}

}  // namespace gonogo::terrain
