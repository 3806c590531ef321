#include "pipeline/inspect/feasible_report.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/units.h"
#include "pipeline/campaign/trial/trial.h"
#include "vehicle/feasible/force_fit.h"
#include "vehicle/model/assembly.h"

namespace gonogo::inspect {
namespace {

constexpr double kSteepest = 80;  // [deg]

/// First slope along, from level ground up, that is not feasible: scanned by half degrees, then halved [deg].
double steepest(const vehicle::Vehicle& v, const FeasibleRequest& r) {
  const auto good = [&](double slope) { return feasible(v, demand_of(r, slope, true)).feasible; };
  if (!good(0)) return 0;
  double low = 0, high = 0;
  do {
    low = high;
    high = std::min(low + 0.5, kSteepest);
    if (low >= kSteepest) return kSteepest;
  } while (good(high));
  while (high - low > 1e-3) {
    const double middle = 0.5 * (low + high);
    (good(middle) ? low : high) = middle;
  }
  return low;
}

double highest_step(const vehicle::Vehicle& v, FeasibleRequest r) {
  r.edge_distance = 0;  // wheels on a step and on the ground share no plane
  double low = 0, high = 0.8 * std::fabs(vehicle::stations(v).front().centre.x - vehicle::stations(v).back().centre.x);
  while (high - low > 1e-3) {
    r.step = 0.5 * (low + high);
    (feasible(v, demand_of(r, r.slope_along, true)).feasible ? low : high) = r.step;
  }
  return low;
}

/// Numbers that may be infinite have no JSON form.
Json finite(double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); }

std::string finite_text(double x) { return std::isfinite(x) ? line("%.3f", x) : "none"; }

/// Without the sign of a rounded zero.
double whole(double x) { return std::round(x) + 0.0; }

void forces(const vehicle::Feasibility& f, Report& r, Json& json) {
  r.text += "  wheel                    normal [N]   along [N]  across [N]\n";
  Json rows = Json::array();
  for (const vehicle::ContactForce& c : f.contact) {
    r.text += line("  %-22s %12.0f %11.0f %11.0f\n", c.wheel.c_str(), whole(c.normal), whole(c.along), whole(c.across));
    rows.push_back(
        Json::Object{{"wheel", c.wheel}, {"normal_N", c.normal}, {"along_N", c.along}, {"across_N", c.across}});
  }
  json["forces"] = rows;
  r.text += "  torques [N m]:";
  Json torques = Json::object();
  for (std::size_t u = 0; u < f.unit.size(); ++u) {
    r.text += line(" %s %.0f%s", f.unit[u].c_str(), whole(f.torque[u]), u + 1 < f.unit.size() ? "," : "\n");
    torques[f.unit[u]] = f.torque[u];
  }
  json["torques_N_m"] = torques;
}

void pressure(const vehicle::Feasibility& f, Report& r, Json& json) {
  if (!f.pressure) return;
  const vehicle::Pressure& p = *f.pressure;
  r.text +=
      line("  centre of pressure %.3f m before and %.3f m left of the origin, %.3f m inside the wheels' polygon\n", p.x,
           p.y, p.edge);
  json["pressure_m"] = Json(std::vector<double>{p.x, p.y});
  json["pressure_edge_m"] = p.edge;
}

Json answer(const vehicle::Vehicle& v, const vehicle::Demand& d, const char* what, Report& r) {
  const vehicle::Feasibility f = feasible(v, d);
  const std::string cause = f.feasible ? "" : limiting_cause(v, d);
  const double friction = min_friction(v, d), torque = min_torque_share(v, d);
  r.text += line("%s: %s%s%s\n", what, f.feasible ? "yes" : "no, limited by ", cause.c_str(),
                 f.climbing.empty()
                     ? ""
                     : line(" (hardest with the %s axle %.0f mm up)", f.climbing.c_str(), 1e3 * f.rise).c_str());
  r.text += line("  reserve %.3f of the mean wheel load; least friction %s; least share of the torque %s\n", f.reserve,
                 finite_text(friction).c_str(), finite_text(torque).c_str());
  Json json;
  json["feasible"] = f.feasible;
  json["cause"] = cause;
  json["reserve"] = finite(f.reserve);
  json["min_friction"] = finite(friction);
  json["min_torque_share"] = finite(torque);
  pressure(f, r, json);
  forces(f, r, json);
  return json;
}

void limits(const vehicle::Vehicle& v, const FeasibleRequest& request, Report& r) {
  if (request.step > 0) return;
  const double slope = steepest(v, request);
  const std::string cause = slope < kSteepest ? limiting_cause(v, demand_of(request, slope + 0.01, true)) : "";
  r.json["steepest_slope_along_deg"] = slope;
  r.json["steepest_cause"] = cause;
  r.text += line("steepest slope along that it climbs, as it leans now: %.2f degrees (%.0f %%), limited by %s\n", slope,
                 100 * std::tan(slope * kDegree), cause.empty() ? "nothing below 80 degrees" : cause.c_str());
  if (v.kind != vehicle::VehicleKind::wheeled || v.axle.size() != 2) return;
  const double step = highest_step(v, request);
  r.json["highest_step_m"] = step;
  r.text += line("highest step that it climbs on this slope: %.0f mm\n", 1e3 * step);
}

}  // namespace

void check_slopes(const FeasibleRequest& request) {
  for (const double slope : {request.slope_along, request.slope_across})
    if (!(std::fabs(slope) <= kSteepest)) throw InputError(line("a slope of %g degrees is outside -80 to 80", slope));
}

vehicle::Demand demand_of(const FeasibleRequest& r, double slope_along, bool moving) {
  return {.gravity = campaign::bed_gravity(slope_along, r.slope_across),
          .friction = r.friction,
          .step = r.step,
          .edge_distance = r.edge_distance,
          .moving = moving};
}

Report check_feasible(const vehicle::Vehicle& v, const FeasibleRequest& request) {
  check_slopes(request);
  Report r;
  r.json["vehicle"] = v.name;
  r.json["slope_along_deg"] = request.slope_along;
  r.json["slope_across_deg"] = request.slope_across;
  r.json["step_m"] = request.step;
  r.json["friction"] = request.friction;
  r.text = line("%s, slope along %g and across %g degrees, step %g m, friction %g\n", v.name.c_str(),
                request.slope_along, request.slope_across, request.step, request.friction);
  if (request.step == 0)
    r.json["holds"] = answer(v, demand_of(request, request.slope_along, false), "holds with brakes", r);
  r.json["moves"] =
      answer(v, demand_of(request, request.slope_along, true), request.step > 0 ? "climbs the step" : "creeps on", r);
  limits(v, request, r);
  return r;
}

namespace {

std::string row_text(const std::string& wheel, int component, const vehicle::FittedForce& f) {
  const std::string fitted = line("  %-22s %-9s %10.0f %9.0f to %.0f", wheel.c_str(),
                                  vehicle::kForceComponent[component], whole(f.force), whole(f.low), whole(f.high));
  const std::string data =
      f.measured ? line("%9.0f %8.0f %9.2f", whole(f.measured->force), f.measured->deviation, f.residual) : "";
  if (data.empty() && f.determined) return fitted + "\n";
  return line("%-66s%-28s", fitted.c_str(), data.c_str()) + (f.determined ? "\n" : "  undetermined\n");
}

Json row_json(const std::string& wheel, int component, const vehicle::FittedForce& f) {
  Json row = Json::Object{{"wheel", wheel},     {"component", vehicle::kForceComponent[component]},
                          {"force_N", f.force}, {"low_N", f.low},
                          {"high_N", f.high},   {"determined", f.determined}};
  row["measured_N"] = f.measured ? Json(f.measured->force) : Json(nullptr);
  row["deviation_N"] = f.measured ? Json(f.measured->deviation) : Json(nullptr);
  row["residual_deviations"] = f.measured ? Json(f.residual) : Json(nullptr);
  return row;
}

void tables(const vehicle::ForceFit& fit, Report& r, Json& json) {
  const std::string fitted = line("  %-22s %-9s %10s %15s", "wheel", "component", "fitted [N]", "range [N]");
  r.text += line("%-66s%9s %8s %9s\n", fitted.c_str(), "data [N]", "+- [N]", "residual");
  json["forces"] = Json::array();
  json["friction_used"] = Json::object();
  std::string used;
  for (const vehicle::FittedContact& c : fit.contact) {
    for (int k = 0; k < 3; ++k) {
      const vehicle::FittedForce& f = c.component[std::size_t(k)];
      r.text += row_text(c.wheel, k, f);
      json["forces"].push_back(row_json(c.wheel, k, f));
    }
    used += line("%s %s %.2f", used.empty() ? "" : ",", c.wheel.c_str(), c.friction_used);
    json["friction_used"][c.wheel] = c.friction_used;
  }
  r.text += "  share of the friction used:" + used + "\n  torques [N m]:";
  json["torques_N_m"] = Json::object();
  for (std::size_t u = 0; u < fit.unit.size(); ++u) {
    r.text += line("%s %s %.0f", u > 0 ? "," : "", fit.unit[u].c_str(), whole(fit.torque[u]));
    json["torques_N_m"][fit.unit[u]] = fit.torque[u];
  }
  r.text += "\n";
}

Json answer(const vehicle::Vehicle& v, const vehicle::Demand& d, const std::vector<vehicle::MeasuredForce>& data,
            const char* what, Report& r) {
  const vehicle::ForceFit fit = fit_forces(v, d, data);
  Json json;
  json["admissible"] = fit.admissible;
  if (!fit.admissible) {
    const std::string cause = limiting_cause(v, d);
    json["cause"] = cause;
    r.text += line("%s: no forces are admissible, limited by %s\n", what, cause.c_str());
    return json;
  }
  json["chi_square"] = fit.chi_square;
  json["degrees_of_freedom"] = fit.degrees;
  r.text += line("%s: chi-square %.4g with %d degree%s of freedom\n", what, fit.chi_square, fit.degrees,
                 fit.degrees == 1 ? "" : "s");
  tables(fit, r, json);
  return json;
}

}  // namespace

Report fit_measured_forces(const vehicle::Vehicle& v, const FeasibleRequest& request,
                           const std::filesystem::path& forces) {
  check_slopes(request);
  const auto data = read_measured_forces(forces, v);
  Report r;
  r.json["vehicle"] = v.name;
  r.json["slope_along_deg"] = request.slope_along;
  r.json["slope_across_deg"] = request.slope_across;
  r.json["friction"] = request.friction;
  r.json["measured"] = int(data.size());
  r.text = line("%s, slope along %g and across %g degrees, friction %g, %d measured components of force\n",
                v.name.c_str(), request.slope_along, request.slope_across, request.friction, int(data.size()));
  r.json["holds"] = answer(v, demand_of(request, request.slope_along, false), data, "holds with brakes", r);
  r.json["moves"] = answer(v, demand_of(request, request.slope_along, true), data, "creeps on", r);
  r.text +=
      "The range holds all admissible forces whose chi-square is at most 1 above the least. Residuals are in +-.\n";
  return r;
}

}  // namespace gonogo::inspect
