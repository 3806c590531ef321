#include "terrain/raster/overlay.h"

#include <cpl_string.h>
#include <gdal_utils.h>

#include <algorithm>
#include <cmath>

#include "base/file.h"
#include "base/line.h"
#include "base/units.h"
#include "terrain/raster/gdal_support.h"

namespace gonogo::terrain {
namespace fs = std::filesystem;
namespace {

struct PictureSize {
  int columns = 1, rows = 1;
};

/// Pixels as wide as high on the ground at the middle latitude; around a pole, where that has no meaning, 4 : 1.
PictureSize picture_size(const DegreeBox& box, int longest) {
  const double wide = box.width() * std::cos((box.south + box.north) / 2 * kDegree), high = box.north - box.south;
  const double ratio = box.width() >= 360 ? 4 : wide / high;
  const auto pixels = [&](double share) { return std::clamp(int(std::lround(longest * share)), 1, longest); };
  return {pixels(std::min(1.0, ratio)), pixels(std::min(1.0, 1 / ratio))};
}

DatasetHandle warped(GDALDataset& source, const GlobePlace& place, const DegreeBox& box, PictureSize size) {
  CPLStringList words;
  for (const char* word : {"-of", "MEM", "-r", "near", "-dstnodata", "255", "-t_srs", place.wkt.c_str(), "-te"})
    words.AddString(word);
  for (const double edge : {box.west, box.south, box.east, box.north}) words.AddString(line("%.15g", edge).c_str());
  words.AddString("-ts");
  words.AddString(std::to_string(size.columns).c_str());
  words.AddString(std::to_string(size.rows).c_str());
  GDALWarpAppOptions* options = GDALWarpAppOptionsNew(words.List(), nullptr);
  GDALDatasetH handle = &source;
  int usage_error = 0;
  DatasetHandle result(GDALDataset::FromHandle(GDALWarp("", nullptr, 1, &handle, options, &usage_error)));
  GDALWarpAppOptionsFree(options);
  return result;
}

/// Warped to degrees and turned into red, green, blue and opacity. Nothing if GDAL cannot do that.
DatasetHandle picture_of(GDALDataset& source, const GlobePlace& place, const DegreeBox& box, PictureSize size) {
  const DatasetHandle turned = warped(source, place, box, size);
  if (!turned) return nullptr;
  const char* words[] = {"-of", "MEM", "-expand", "rgba", nullptr};
  GDALTranslateOptions* options = GDALTranslateOptionsNew(const_cast<char**>(words), nullptr);
  int usage_error = 0;
  DatasetHandle coloured(GDALDataset::FromHandle(GDALTranslate("", turned.get(), options, &usage_error)));
  GDALTranslateOptionsFree(options);
  return coloured;
}

std::string overlay_text(const DegreeBox& box, const std::string& picture, const std::string& title,
                         const std::string& description) {
  return "<GroundOverlay>\n  <name>" + xml_escaped(title) + "</name>\n  <description>" + xml_escaped(description) +
         "</description>\n  <Icon><href>" + xml_escaped(picture) + "</href></Icon>\n" +
         line("  <LatLonBox><north>%.9f</north><south>%.9f</south><east>%.9f</east><west>%.9f</west></LatLonBox>\n",
              box.north, box.south, box.east, box.west) +
         "</GroundOverlay>\n";
}

/// The hint names the globe on which to draw (Google's KML reference, element kml).
std::string kml_text(const GlobePlace& place, const std::vector<std::string>& overlays) {
  std::string hint, text;
  if (!place.is_wgs84 && place.body == "Moon") hint = " hint=\"target=moon\"";
  if (!place.is_wgs84 && place.body == "Mars") hint = " hint=\"target=mars\"";
  for (const std::string& overlay : overlays) text += overlay;
  if (overlays.size() > 1) text = "<Folder>\n" + text + "</Folder>\n";
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<kml xmlns=\"http://www.opengis.net/kml/2.2\"" + hint + ">\n" +
         text + "</kml>\n";
}

void write_png(const fs::path& png, GDALDataset& picture, const GdalCall& call) {
  replace_file_atomically(png, [&](const fs::path& temporary) {
    CPLSetThreadLocalConfigOption("GDAL_PAM_ENABLED", "NO");
    GDALDriver* driver = GetGDALDriverManager()->GetDriverByName("PNG");
    const DatasetHandle written(
        driver ? driver->CreateCopy(temporary.c_str(), &picture, FALSE, nullptr, nullptr, nullptr) : nullptr);
    CPLSetThreadLocalConfigOption("GDAL_PAM_ENABLED", nullptr);
    if (!written) refuse_to_write(png, call);
  });
}

fs::path piece_file(const fs::path& png, std::size_t piece) {
  if (piece == 0) return png;
  return png.parent_path() / (png.stem().string() + "_" + std::to_string(piece + 1) + png.extension().string());
}

}  // namespace

std::string xml_escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else if (static_cast<unsigned char>(c) < 32 && c != '\n' && c != '\t')
      out += ' ';
    else
      out += c;
  }
  return out;
}

OverlayAnswer write_overlay(const fs::path& kml, const fs::path& png, const fs::path& layer, const GlobePlace& place,
                            const std::string& title, const std::string& description,
                            const std::vector<LegendEntry>& legend, int longest) {
  GdalCall call;
  const DatasetHandle source = open_reduced(layer, 4.0 * longest * longest);
  const int side = std::min(longest, std::max(source->GetRasterXSize(), source->GetRasterYSize()));
  std::vector<DatasetHandle> pictures;
  for (const DegreeBox& box : place.pieces) {
    pictures.push_back(picture_of(*source, place, box, picture_size(box, side)));
    if (!pictures.back()) return {{}, "the map cannot be turned to degrees (" + call.message() + ")"};
  }
  std::string list = description + "\n";
  for (const LegendEntry& entry : legend) list += entry.label + ": " + entry.colour + "\n";
  OverlayAnswer answer;
  std::vector<std::string> overlays;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const fs::path file = piece_file(png, i);
    write_png(file, *pictures[i], call);
    answer.files.push_back(file);
    overlays.push_back(overlay_text(place.pieces[i], file.filename().string(), title, list));
  }
  write_file_atomically(kml, kml_text(place, overlays));
  answer.files.insert(answer.files.begin(), kml);
  return answer;
}

}  // namespace gonogo::terrain
