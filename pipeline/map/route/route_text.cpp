#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdio>

#include "base/error.h"
#include "base/line.h"
#include "pipeline/map/route/drive_of_way.h"
#include "pipeline/map/route/plan_route.h"

namespace gonogo::map {

Place parse_place(const std::string& text, const std::string& where) {
  Place place;
  const std::size_t comma = text.find(',');
  const auto number = [&](std::size_t from, std::size_t to, double& value) {
    const auto [end, error] = std::from_chars(text.data() + from, text.data() + to, value);
    return error == std::errc() && end == text.data() + to && std::isfinite(value);
  };
  if (comma == std::string::npos || !number(0, comma, place.x) || !number(comma + 1, text.size(), place.y))
    throw InputError(where + ": \"" + text + "\" is no place; give easting,northing in the region's coordinate system");
  return place;
}

std::int64_t parse_departure(const std::string& text, const std::string& where) {
  int year = 0, month = 0, day = 0, hour = 0, minute = 0, second = 0, used = 0;
  const bool read = std::sscanf(text.c_str(), "%4d-%2d-%2dT%2d:%2d:%2dZ%n", &year, &month, &day, &hour, &minute,
                                &second, &used) == 6 &&
                    used == int(text.size()) && text.size() == 20;
  const std::chrono::year_month_day date{std::chrono::year(year), std::chrono::month(unsigned(month)),
                                         std::chrono::day(unsigned(day))};
  if (!read || !date.ok() || hour > 23 || minute > 59 || second > 59)
    throw InputError(where + ": \"" + text + "\" is no time; give it as in 2026-05-01T06:00:00Z");
  const auto days = std::chrono::sys_days(date).time_since_epoch().count();
  return std::int64_t(days) * 86400 + hour * 3600 + minute * 60 + second;
}

std::string route_text(const Json& result) {
  std::string text;
  for (const Json& route : result.at("routes").items()) {
    const std::string& cost = route.at("cost").string();
    if (!route.at("found").boolean()) {
      text += line("%-13s no way is known: every path crosses cells that are no-go or unknown in its direction\n",
                   cost.c_str());
      continue;
    }
    text += line("%-13s %8.3f km, chance to get through %.2f", cost.c_str(), route.at("length_m").number() / 1000,
                 route.at("chance").number());
    if (const Json* time = route.find("time_s")) text += line(", %.0f s", time->number());
    if (const Json* energy = route.find("energy_j")) text += line(", %.3f MJ of drive energy", energy->number() / 1e6);
    text += line(", stuck at %.2g places\n", route.at("stuck_places").number());
    if (const Json* turned = route.find("turned_degrees"))
      text += line("              turns by %.0f degrees in all, which count as %.0f m\n", turned->number(),
                   route.at("turning_m").number());
    if (const Json* weakest = route.find("weakest")) text += "              weakest " + weakest_text(*weakest) + "\n";
    if (route.at("not_sampled").number() > 0)
      text += line("              with a chance of %.2f some soil on it is unlike all that was simulated\n",
                   route.at("not_sampled").number());
  }
  if (const Json* regions = result.find("regions"))
    text +=
        line("%.0f connected regions; the largest holds %.4g of %.4g km2 that some heading passes\n",
             regions->at("count").number(), regions->at("largest_km2").number(), regions->at("passable_km2").number());
  for (const Json& file : result.at("files").items()) text += file.string() + "\n";
  return text;
}

}  // namespace gonogo::map
