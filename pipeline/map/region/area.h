// Number of cells of a region by class and reason.
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "base/json/json.h"
#include "pipeline/campaign/study/contract.h"

namespace gonogo::map {

class AreaCount {
 public:
  void add(campaign::Verdict verdict, campaign::Reason reason, std::uint64_t cells = 1) {
    cells_[{verdict, reason}] += cells;
  }

  std::uint64_t total() const;
  std::uint64_t cells(campaign::Verdict verdict) const;
  std::uint64_t cells(campaign::Verdict verdict, campaign::Reason reason) const;
  /// Share of all counted cells [0, 1]; 0 if none were counted. A map counts the cells that have a slope.
  double share(campaign::Verdict verdict) const;
  double share(campaign::Verdict verdict, campaign::Reason reason) const;

  /// Columns class, reason, cells, area_km2, share. Classes in the contract's order, each followed by its reasons that
  /// occur.
  std::string csv(double cell_area_m2) const;
  Json to_json() const;
  static AreaCount from_json(const Json& json);

 private:
  std::map<std::pair<campaign::Verdict, campaign::Reason>, std::uint64_t> cells_;
};

}  // namespace gonogo::map
