// Shared by the elastic cases.
#pragma once
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "base/error.h"
#include "pipeline/lab/validate/elastic/elastic.h"
#include "sim/elastic/mesh.h"
#include "sim/elastic/simulation.h"

namespace gonogo::lab {

namespace el = sim::elastic;

inline CheckFigure figure_of(const std::string& name, const std::string& csv_header) {
  return {.name = name, .csv = csv_header};
}

inline report::LinePlot plot_of(const std::string& title, const std::string& x, const std::string& y,
                                std::vector<report::PlotLine> lines, bool from_zero = true) {
  return {.title = title, .x_label = x, .y_label = y, .lines = std::move(lines), .from_zero = from_zero};
}

inline bool near(double a, double b) { return std::fabs(a - b) < 1e-9; }

/// A run that failed makes every number after it meaningless.
inline void need_finished(const el::MarchReport& r, const std::string& what) {
  if (!r.finished) throw DeviceError(what + " did not finish: " + r.reason);
}

/// Largest distance from the middle, along x, of points for which `holds`, halfway to the next point outward.
template <class Holds>
double extent(const std::vector<el::ContactPoint>& points, double side, const Holds& holds) {
  double last = 0, beyond = 1e300;
  for (const el::ContactPoint& p : points)
    if (p.place.x * side > 0 && holds(p)) last = std::max(last, p.place.x * side);
  for (const el::ContactPoint& p : points)
    if (p.place.x * side > last) beyond = std::min(beyond, p.place.x * side);
  return (last + beyond) / 2;
}

inline bool touches(const el::ContactPoint& p) { return p.touch != el::Touch::open; }

}  // namespace gonogo::lab
