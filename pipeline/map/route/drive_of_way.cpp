#include "pipeline/map/route/drive_of_way.h"

#include <cmath>

#include "base/line.h"
#include "base/units.h"
#include "pipeline/map/route/line_walk.h"
#include "pipeline/map/route/track.h"

namespace gonogo::map {

std::vector<DrivePiece> pieces_of(const FoundRoute& route, const RouteCells& cells, const RouteCosts& length) {
  std::vector<DrivePiece> pieces;
  double driven = 0;
  const auto columns = std::uint32_t(cells.columns);
  for (std::size_t i = 1; i < route.cell.size(); ++i) {
    const LineOfCells line(cells, route.cell[i - 1], route.cell[i]);
    walk_line(
        cells.columns, route.cell[i - 1], route.cell[i],
        [&](std::uint32_t cell, double begin, double end) {
          const double rise = std::tan(cells.slope[cell] / kSlopeSteps * kDegree);
          const double downhill = cells.aspect[cell] * kDegree;
          const double next =
              driven + line.length * (end - begin) * double(length.per_metre(cells, cell, line.heading));
          pieces.push_back({.begin = driven,
                            .end = next,
                            .soil = cells.soil[cell],
                            .rise_east = -rise * std::sin(downhill),
                            .rise_north = -rise * std::cos(downhill),
                            .heading = double(line.heading),
                            .column = int(cell % columns),
                            .row = int(cell / columns)});
          driven = next;
          return true;
        },
        [](std::uint32_t, std::uint32_t) { return true; });
  }
  return pieces;
}

std::vector<std::array<double, 2>> line_over(const FoundRoute& route, const terrain::MapGrid& grid, std::size_t first,
                                             std::size_t last) {
  std::vector<std::array<double, 2>> line;
  std::size_t piece = 0;
  for (std::size_t i = 1; i < route.cell.size(); ++i) {
    const terrain::TrackPoint a = centre_of(route.cell[i - 1], grid), b = centre_of(route.cell[i], grid);
    const auto add = [&](double share) { line.push_back({a.x + share * (b.x - a.x), a.y + share * (b.y - a.y)}); };
    walk_line(
        grid.columns, route.cell[i - 1], route.cell[i],
        [&](std::uint32_t, double begin, double end) {
          if (piece == first) add(begin);
          if (piece >= first && piece <= last) add(end);
          ++piece;
          return true;
        },
        [](std::uint32_t, std::uint32_t) { return true; });
  }
  return line;
}

DriveDoubt drive_doubt(const RegionRaster& elevation, const MapRules& rules, const terrain::MapGrid& grid) {
  DriveDoubt doubt;
  doubt.bed_length = rules.correlation_length;
  doubt.height_error = elevation.error * std::sqrt(1 - elevation.error_correlation);
  doubt.cell_width = grid.cell_width_m();
  doubt.cell_height = grid.cell_height_m();
  return doubt;
}

std::vector<DriveSoil> drive_soils(const SoilTable& table) {
  std::vector<DriveSoil> soils;
  for (std::size_t s = 0; s < table.responses.size(); ++s) {
    const SoilPoints& points = table.responses[s].points();
    const std::size_t count = points.sampled_count();
    DriveSoil soil{.name = s < table.soils.size() ? table.soils[s].name : std::string(), .points = {}};
    const std::size_t variables = count > 0 ? points.sampled().size() / count : 0;
    for (std::size_t i = 0; i < count; ++i) {
      const auto row = points.sampled().subspan(i * variables, variables);
      soil.points.emplace_back(row.begin(), row.end());
    }
    soil.not_sampled = 1 - double(count) / double(points.all().size());
    soils.push_back(std::move(soil));
  }
  return soils;
}

Json forecast_json(const DriveForecast& forecast, const std::vector<DrivePiece>& pieces,
                   const std::vector<DriveSoil>& soils) {
  Json json = Json::object();
  json["chance"] = forecast.chance;
  json["chance_error"] = forecast.error;
  json["stuck_places"] = forecast.places;
  json["not_sampled"] = forecast.not_sampled;
  if (!forecast.weakest) return json;
  const WeakestStretch& stretch = *forecast.weakest;
  const DrivePiece& piece = pieces[stretch.piece];
  const SlopesOnWay slopes = slopes_on_way(piece);
  Json weakest = Json::object();
  weakest["from_km"] = stretch.begin / 1000;
  weakest["to_km"] = stretch.end / 1000;
  weakest["stuck"] = stretch.stuck;
  weakest["reason"] = campaign::contract().info(campaign::contract().outcomes[stretch.outcome].reason).label;
  weakest["soil"] = soils[piece.soil].name;
  weakest["slope_along_deg"] = to_degrees(std::atan(slopes.along));
  weakest["slope_across_deg"] = to_degrees(std::atan(slopes.across));
  json["weakest"] = weakest;
  return json;
}

std::string weakest_text(const Json& weakest) {
  return line("km %.2f to %.2f: %s in %.1f %% of the draws, %s, slope %.0f degrees along and %.0f across",
              weakest.at("from_km").number(), weakest.at("to_km").number(), weakest.at("reason").string().c_str(),
              100 * weakest.at("stuck").number(), weakest.at("soil").string().c_str(),
              weakest.at("slope_along_deg").number(), weakest.at("slope_across_deg").number());
}

}  // namespace gonogo::map
