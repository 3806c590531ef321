#include "terrain/raster/gpx.h"

#include <chrono>
#include <cmath>

#include "base/error.h"
#include "base/file.h"
#include "base/line.h"
#include "terrain/raster/gdal_support.h"
#include "terrain/raster/overlay.h"
#include "terrain/raster/to_wgs84.h"

namespace gonogo::terrain {
namespace {

/// "2026-05-01T06:00:12Z"; milliseconds only where there are any.
std::string time_text(std::int64_t departure, double seconds) {
  const std::int64_t all = departure * 1000 + std::llround(seconds * 1000);
  const std::chrono::sys_time<std::chrono::milliseconds> moment{std::chrono::milliseconds(all)};
  const auto day = std::chrono::floor<std::chrono::days>(moment);
  const std::chrono::year_month_day date(day);
  const std::chrono::hh_mm_ss clock(moment - day);
  const auto rest = int(clock.subseconds().count());
  return line("%04d-%02u-%02uT%02d:%02d:%02d", int(date.year()), unsigned(date.month()), unsigned(date.day()),
              int(clock.hours().count()), int(clock.minutes().count()), int(clock.seconds().count())) +
         (rest ? line(".%03dZ", rest) : "Z");
}

class GpxText {
 public:
  GpxText(const MapGrid& grid, const std::filesystem::path& path, std::int64_t departure)
      : turn_(to_wgs84(grid, path)), path_(path), departure_(departure) {}

  std::string point(const char* element, const TrackPoint& point, const std::string& name) const {
    double x = point.x, y = point.y;
    if (!turn_->Transform(1, &x, &y))
      throw InputError(path_.string() +
                       line(": the place %.10g,%.10g has no longitude and latitude", point.x, point.y));
    std::string text = line("<%s lat=\"%.8f\" lon=\"%.8f\">", element, y, x);
    if (!std::isnan(point.height)) text += line("<ele>%.2f</ele>", point.height);
    if (!std::isnan(point.seconds)) text += "<time>" + time_text(departure_, point.seconds) + "</time>";
    if (!name.empty()) text += "<name>" + xml_escaped(name) + "</name>";
    return text + "</" + element + ">\n";
  }

 private:
  std::unique_ptr<OGRCoordinateTransformation> turn_;
  std::filesystem::path path_;
  std::int64_t departure_;
};

}  // namespace

void write_gpx(const std::filesystem::path& path, const MapGrid& grid, const std::vector<Stop>& stops,
               const std::vector<Track>& tracks, std::int64_t departure) {
  const GdalCall call;
  const GpxText gpx(grid, path, departure);
  std::string text =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<gpx version=\"1.1\" creator=\"gonogo\" "
      "xmlns=\"http://www.topografix.com/GPX/1/1\">\n";
  for (const Stop& stop : stops) text += gpx.point("wpt", stop.at, stop.name);
  for (const Track& track : tracks) {
    text += "<trk><name>" + xml_escaped(track.name) + "</name><trkseg>\n";
    for (const TrackPoint& point : track.point) text += gpx.point("trkpt", point, "");
    text += "</trkseg></trk>\n";
  }
  write_file_atomically(path, text + "</gpx>\n");
}

}  // namespace gonogo::terrain
