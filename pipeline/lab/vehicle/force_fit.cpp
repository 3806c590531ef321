#include "pipeline/lab/vehicle/force_fit.h"

#include <cmath>

#include "vehicle/feasible/force_fit.h"

namespace gonogo::lab {
namespace {

using namespace vehicle;

/// Without the sign of a rounded zero.
double whole(double x) { return std::round(x) + 0.0; }

std::string row_text(const std::string& wheel, int component, const FittedForce& f) {
  const std::string fitted = line("  %-22s %-9s %10.0f %9.0f to %.0f", wheel.c_str(), kForceComponent[component],
                                  whole(f.force), whole(f.low), whole(f.high));
  const std::string data =
      f.measured ? line("%9.0f %8.0f %9.2f", whole(f.measured->force), f.measured->deviation, f.residual) : "";
  if (data.empty() && f.determined) return fitted + "\n";
  return line("%-66s%-28s", fitted.c_str(), data.c_str()) + (f.determined ? "\n" : "  undetermined\n");
}

Json row_json(const std::string& wheel, int component, const FittedForce& f) {
  Json row;
  row["wheel"] = wheel;
  row["component"] = kForceComponent[component];
  row["force_N"] = f.force;
  row["low_N"] = f.low;
  row["high_N"] = f.high;
  row["determined"] = f.determined;
  row["measured_N"] = f.measured ? Json(f.measured->force) : Json(nullptr);
  row["deviation_N"] = f.measured ? Json(f.measured->deviation) : Json(nullptr);
  row["residual_deviations"] = f.measured ? Json(f.residual) : Json(nullptr);
  return row;
}

void tables(const ForceFit& fit, Report& r, Json& json) {
  const std::string fitted = line("  %-22s %-9s %10s %15s", "wheel", "component", "fitted [N]", "range [N]");
  r.text += line("%-66s%9s %8s %9s\n", fitted.c_str(), "data [N]", "+- [N]", "residual");
  json["forces"] = Json::array();
  json["friction_used"] = Json::object();
  std::string used;
  for (const FittedContact& c : fit.contact) {
    for (int k = 0; k < 3; ++k) {
      const FittedForce& f = c.component[std::size_t(k)];
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

Json answer(const Vehicle& v, const Demand& d, const std::vector<MeasuredForce>& data, const char* what, Report& r) {
  const ForceFit fit = fit_forces(v, d, data);
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

Report fit_measured_forces(const Vehicle& v, const FeasibleRequest& request, const std::filesystem::path& forces) {
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

}  // namespace gonogo::lab
