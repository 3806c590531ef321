// The ring fitted to a measured tyre at one load and pressure, against what was measured at others; beside it the
// compliant tyre of the engine, a foundation under a cylinder, of the same deflection at the nominal load.
#include <algorithm>

#include "base/format.h"
#include "pipeline/lab/validate/elastic/elastic.h"
#include "pipeline/lab/validate/elastic/measured_tyre.h"
#include "pipeline/lab/validate/elastic/parts.h"
#include "sim/elastic/tyre/tyre.h"
#include "vehicle/model/statics.h"

namespace gonogo::lab {
namespace {

namespace measured = measured_tyre;

constexpr int kFine = 360, kCoarse = 120;       // nodes of statics and of rolling
constexpr double kSoft = 180e3, kHard = 260e3;  // pressures beside the nominal one [Pa]
const std::vector<double> kLoads{1000, 2000, 3000, 4000, 5000, 6000, 7000, 8000};  // [N]

const el::Tyre& fine_tyre() {
  static const el::Tyre fitted = fitted_tyre(kFine);
  return fitted;
}

std::vector<Patch> patches(double pressure) {
  el::Tyre t = fine_tyre();
  t.pressure = pressure;
  std::vector<Patch> found;
  for (const double load : kLoads) found.push_back(pressed(t, load));
  return found;
}

const std::vector<Patch>& nominal_patches() {
  static const std::vector<Patch> found = patches(measured::kPressure);
  return found;
}

/// Deflection and contact length of the compliant tyre on flat ground, from the spring that it gives a grain.
Patch compliant(double load) {
  vehicle::Wheel wheel;
  wheel.radius = measured::kRadius;
  wheel.width = fine_tyre().width;
  wheel.compliant = {measured::kLoad / measured::deflection(measured::kLoad, measured::kPressure), 0};
  constexpr double kGrain = 1e-3;
  const double per_area = vehicle::contact_spring(wheel, measured::kLoad, kGrain).stiffness / (kGrain * kGrain);
  // 4/3 c b d sqrt(2 r d) = load
  const double d = std::pow(0.75 * load / (per_area * wheel.width * std::sqrt(2 * wheel.radius)), 2.0 / 3);
  return {d, 2 * std::sqrt(2 * wheel.radius * d)};
}

/// The ratio farthest from 1.
double worst(const std::vector<double>& ratios) {
  return *std::max_element(ratios.begin(), ratios.end(),
                           [](double a, double b) { return std::fabs(std::log(a)) < std::fabs(std::log(b)); });
}

struct Curves {
  report::PlotLine measured{.label = "measured tyre"}, ring{.label = "ring", .points = true},
      foundation{.label = "compliant tyre of the engine"};
  void add(double x, double m, double r, double f) {
    measured.add(x, m);
    ring.add(x, r);
    foundation.add(x, f);
  }
};

}  // namespace

CheckFigure elastic_tyre_load() {
  CheckFigure figure = figure_of("elastic_tyre_load",
                                 "load_n,measured_m,ring_m,compliant_m,measured_180kpa_m,ring_180kpa_m,"
                                 "measured_260kpa_m,ring_260kpa_m\n");
  const std::vector<Patch>&now = nominal_patches(), soft = patches(kSoft), hard = patches(kHard);
  Curves c;
  std::vector<double> others, pressures, foundation;
  for (std::size_t i = 0; i < kLoads.size(); ++i) {
    const double load = kLoads[i], m = measured::deflection(load, measured::kPressure),
                 s = measured::deflection(load, kSoft), h = measured::deflection(load, kHard),
                 f = compliant(load).deflection;
    figure.csv += line("%g,%.5g,%.5g,%.5g,%.5g,%.5g,%.5g,%.5g\n", load, m, now[i].deflection, f, s, soft[i].deflection,
                       h, hard[i].deflection);
    c.add(1e3 * m, load, load, load);
    c.ring.x.back() = 1e3 * now[i].deflection;
    c.foundation.x.back() = 1e3 * f;
    others.push_back(now[i].deflection / m);
    if (load != measured::kLoad) foundation.push_back(f / m);
    pressures.push_back(soft[i].deflection / s);
    pressures.push_back(hard[i].deflection / h);
  }
  const el::Tyre& t = fine_tyre();
  const double shift = std::sqrt(el::sidewall_stiffness(t).shift / measured::shift_stiffness());
  figure.check = {
      {"tyre_bending_n_m2", "Tyre, fitted: bending stiffness of the belt [N m^2]", 1, 20, t.bending},
      {"tyre_tangential_n_m2", "Tyre, fitted: tangential springs of the sidewalls [N/m^2]", 1e5, 1e6, t.tangential},
      {"tyre_deflection_nominal", "Tyre: deflection at 4 kN, 2.2 bar over measured", 0.94, 1.06, others[3]},
      {"tyre_deflection_ratio", "Tyre: deflection at 1 to 8 kN over measured, worst", 0.92, 1.08, worst(others)},
      {"tyre_pressure_ratio", "Tyre: deflection at 1 to 8 kN, 1.8 and 2.6 bar over measured, worst", 0.92, 1.08,
       worst(pressures)},
      {"tyre_shift_frequency_ratio", "Tyre: frequency of the belt along the ground over measured", 0.85, 1.15, shift},
      {"compliant_deflection_ratio", "Compliant tyre of the engine: deflection at 1 to 8 kN over measured, worst", 0.5,
       2, worst(foundation)}};
  figure.plot =
      plot_of("Car tyre 205/60 R15 on flat ground", "deflection [mm]", "load [N]", {c.measured, c.ring, c.foundation});
  return figure;
}

CheckFigure elastic_tyre_patch() {
  CheckFigure figure = figure_of("elastic_tyre_patch", "load_n,measured_m,ring_m,compliant_m\n");
  const std::vector<Patch>& now = nominal_patches();
  Curves c;
  std::vector<double> others, foundation;
  for (std::size_t i = 0; i < kLoads.size(); ++i) {
    const double load = kLoads[i], m = measured::contact_length(load, measured::kPressure), f = compliant(load).length;
    figure.csv += line("%g,%.5g,%.5g,%.5g\n", load, m, now[i].length, f);
    c.add(load, 1e3 * m, 1e3 * now[i].length, 1e3 * f);
    if (load != measured::kLoad) others.push_back(now[i].length / m);
    foundation.push_back(f / m);
  }
  const double mean = measured::kLoad / (now[3].length * fine_tyre().width);
  figure.check = {
      {"tyre_length_fitted", "Tyre, fitted: contact length at 4 kN, 2.2 bar over measured", 0.99, 1.01,
       now[3].length / measured::contact_length(measured::kLoad, measured::kPressure)},
      {"tyre_length_ratio", "Tyre: contact length at 1 to 8 kN over measured, worst", 0.87, 1.13, worst(others)},
      {"tyre_mean_pressure_ratio", "Tyre: mean pressure of the contact at 4 kN over that of the air", 0.9, 1.1,
       mean / measured::kPressure},
      {"compliant_length_ratio", "Compliant tyre of the engine: contact length over measured, worst", 1.2, 3,
       worst(foundation)}};
  figure.plot = plot_of("Car tyre 205/60 R15 on flat ground", "load [N]", "contact length [mm]",
                        {c.measured, c.ring, c.foundation});
  return figure;
}

CheckFigure elastic_tyre_rolling() {
  CheckFigure figure = figure_of("elastic_tyre_rolling", "load_n,pressure_pa,measured_n_m,ring_n_m,balance\n");
  el::Tyre t = fine_tyre();
  t.nodes = kCoarse;
  t.loss = fitted_loss(t);
  report::PlotLine points{.label = "ring", .points = true}, curve{.label = "measured tyre"};
  double unbalanced = 0, work = 0;
  const auto ratio = [&](double load, double pressure) {
    const Rolling r = rolling(t, load, pressure);
    const double m = measured::rolling_moment(load, pressure, measured::kSpeed);
    figure.csv += line("%g,%g,%.5g,%.5g,%.3g\n", load, pressure, m, r.moment, r.balance);
    unbalanced = std::max(unbalanced, std::fabs(r.balance));
    work = std::max(work, std::fabs(r.worked / r.lost - 1));
    if (pressure == measured::kPressure) {
      points.add(load, r.moment);
    }
    return r.moment / m;
  };
  const double fitted = ratio(measured::kLoad, measured::kPressure);
  const double loads =
      worst({ratio(2000, measured::kPressure), ratio(6000, measured::kPressure), ratio(8000, measured::kPressure)});
  const double pressures = worst({ratio(measured::kLoad, kSoft), ratio(measured::kLoad, kHard)});
  for (double load = 1000; load <= 8000; load += 250) {
    curve.add(load, measured::rolling_moment(load, measured::kPressure, measured::kSpeed));
  }
  const std::string over = "Tyre: rolling resistance over measured, worst: ";
  figure.check = {
      {"tyre_loss_factor", "Tyre, fitted: loss factor", 0.05, 0.3, t.loss},
      {"tyre_rolling_fitted", "Tyre, fitted: rolling resistance over measured, 4 kN, 2.2 bar", 0.99, 1.01, fitted},
      {"tyre_rolling_ratio", over + "2, 6 and 8 kN", 0.75, 1.25, loads},
      {"tyre_rolling_pressure_ratio", over + "1.8 and 2.6 bar", 0.95, 1.05, pressures},
      {"tyre_rolling_balance", "Tyre: work of the hub less what is stored and lost, over the work", 0, 1e-3,
       unbalanced},
      {"tyre_rolling_work", "Tyre: work of the hub over the loss of rubber, less 1, worst", 0, 0.03, work}};
  figure.plot =
      plot_of("Car tyre 205/60 R15 at 60 km/h, 2.2 bar", "load [N]", "rolling resistance [N m]", {curve, points});
  return figure;
}

}  // namespace gonogo::lab
