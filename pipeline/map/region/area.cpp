#include "pipeline/map/region/area.h"

#include <algorithm>
#include <cmath>

#include "base/format.h"
#include "base/units.h"

namespace gonogo::map {

namespace {

std::string csv_row(const std::string& verdict, const std::string& reason, std::uint64_t cells, double area_km2,
                    double share) {
  return line("%s,%s,%llu,%.6f,%.6f\n", verdict.c_str(), reason.c_str(), static_cast<unsigned long long>(cells),
              area_km2, share);
}

}  // namespace

std::uint64_t AreaCount::total() const {
  std::uint64_t sum = 0;
  for (const auto& [key, count] : cells_) sum += count;
  return sum;
}

std::uint64_t AreaCount::cells(campaign::Verdict verdict) const {
  std::uint64_t sum = 0;
  for (const auto& [key, count] : cells_) sum += key.first == verdict ? count : 0;
  return sum;
}

std::uint64_t AreaCount::cells(campaign::Verdict verdict, campaign::Reason reason) const {
  const auto found = cells_.find({verdict, reason});
  return found == cells_.end() ? 0 : found->second;
}

double AreaCount::share(campaign::Verdict verdict) const {
  return total() ? double(cells(verdict)) / double(total()) : 0;
}

double AreaCount::share(campaign::Verdict verdict, campaign::Reason reason) const {
  return total() ? double(cells(verdict, reason)) / double(total()) : 0;
}

std::string AreaCount::csv(double cell_area_m2) const {
  std::string text = "class,reason,cells,area_km2,share\n";
  for (const campaign::VerdictInfo& info : campaign::contract().verdicts) {
    const campaign::Verdict verdict = campaign::Verdict(info.code);
    text += csv_row(info.name, "all", cells(verdict), double(cells(verdict)) * cell_area_m2 * 1e-6, share(verdict));
    for (const campaign::ReasonInfo& reason : campaign::contract().reasons)
      if (const std::uint64_t count = cells(verdict, campaign::Reason(reason.code)))
        text += csv_row(info.name, reason.name, count, double(count) * cell_area_m2 * 1e-6,
                        share(verdict, campaign::Reason(reason.code)));
  }
  return text;
}

Json AreaCount::to_json() const {
  Json rows = Json::array();
  for (const auto& [key, count] : cells_) {
    rows.push_back(Json::Object{{"class", campaign::contract().info(key.first).name},
                                {"reason", campaign::contract().info(key.second).name},
                                {"cells", count}});
  }
  return rows;
}

AreaCount AreaCount::from_json(const Json& json) {
  AreaCount area;
  for (const Json& row : json.items())
    for (const campaign::VerdictInfo& verdict : campaign::contract().verdicts)
      for (const campaign::ReasonInfo& reason : campaign::contract().reasons)
        if (row.at("class").string() == verdict.name && row.at("reason").string() == reason.name)
          area.add(campaign::Verdict(verdict.code), campaign::Reason(reason.code), row.at("cells").unsigned_integer());
  return area;
}

int SpeedCurve::step_of(double speed) {
  if (!(speed > 0)) return 0;
  return std::clamp(int(std::lround(speed / kStep)), 1, kSteps - 1);
}

std::string SpeedCurve::csv() const {
  std::uint64_t known = 0;
  for (const std::uint64_t cells : cells_) known += cells;
  std::string text = "percent_of_known_area,slowest_km_h,mean_km_h\n";
  std::uint64_t taken = 0;
  double time = 0;  // over the cells taken so far, one metre in each
  int step = kSteps - 1;
  std::uint64_t left = cells_[std::size_t(step)];
  for (int percent = 1; percent <= 100 && known > 0; ++percent) {
    const std::uint64_t wanted = std::max<std::uint64_t>(1, known * std::uint64_t(percent) / 100);
    while (taken < wanted) {
      while (left == 0) left = cells_[std::size_t(--step)];
      const std::uint64_t some = std::min(left, wanted - taken);
      time += step > 0 ? double(some) / (step * kStep) : INFINITY;
      taken += some;
      left -= some;
    }
    text += line("%d,%.2f,%.4f\n", percent, kKmPerHour * step * kStep,
                 std::isinf(time) ? 0.0 : kKmPerHour * double(taken) / time);
  }
  const std::uint64_t all = known + unknown_;
  return text + line("unknown,%.6f of all cells,\n", all > 0 ? double(unknown_) / double(all) : 0.0);
}

}  // namespace gonogo::map
