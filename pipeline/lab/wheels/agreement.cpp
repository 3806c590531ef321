#include "pipeline/lab/wheels/agreement.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"

namespace gonogo::lab {
namespace {

constexpr double kZero = 1e-9;  // measured values of this size have no relative error

double median(std::vector<double> values) {
  if (values.empty()) return std::nan("");
  if (std::any_of(values.begin(), values.end(), [](double x) { return std::isnan(x); })) return std::nan("");
  std::sort(values.begin(), values.end());
  const std::size_t n = values.size();
  return n % 2 == 1 ? values[n / 2] : (values[n / 2 - 1] + values[n / 2]) / 2;
}

double factor(double predicted, double measured) {
  if (std::isnan(predicted)) return predicted;
  const double ratio = predicted / measured;
  return ratio > 0 ? std::max(ratio, 1 / ratio) : std::numeric_limits<double>::infinity();
}

struct Sums {
  double square = 0, bias = 0;
  void add(double off, double count) {
    square += off * off / count;
    bias += off / count;
  }
};

}  // namespace

Agreement agreement_of(const std::vector<ComparedValue>& values) {
  Agreement a;
  a.points = int(values.size());
  Sums plain, over_load;
  std::vector<double> relative;
  for (const ComparedValue& v : values) {
    const double off = v.predicted - v.measured;
    plain.add(off, a.points);
    over_load.add(off / v.load, a.points);
    if (std::fabs(v.measured) > kZero || std::isnan(off)) {
      relative.push_back(std::fabs(off / v.measured));
      const double worst = factor(v.predicted, v.measured);
      a.worst_factor = std::isnan(worst) || worst > a.worst_factor ? worst : a.worst_factor;
    }
    if (!(v.scatter > 0)) continue;
    ++a.with_scatter;
    a.inside += std::fabs(off) <= v.scatter;
    a.band_meets += v.high >= v.measured - v.scatter && v.low <= v.measured + v.scatter;
  }
  a.rms = std::sqrt(plain.square);
  a.bias = plain.bias;
  a.rms_over_load = std::sqrt(over_load.square);
  a.bias_over_load = over_load.bias;
  a.median_relative_error = median(relative);
  return a;
}

const std::vector<std::string>& measure_names() {
  static const std::vector<std::string> names{"rms", "rms_over_load", "median_relative_error", "worst_factor"};
  return names;
}

double measure_of(const Agreement& a, const std::string& name) {
  if (name == "rms") return a.rms;
  if (name == "rms_over_load") return a.rms_over_load;
  if (name == "median_relative_error") return a.median_relative_error;
  if (name == "worst_factor") return a.worst_factor;
  throw InputError("\"" + name + "\" is no measure of agreement");
}

Json as_json(const Agreement& a) {
  return Json::Object{{"points", a.points},
                      {"rms", a.rms},
                      {"bias", a.bias},
                      {"rms_over_load", a.rms_over_load},
                      {"bias_over_load", a.bias_over_load},
                      {"median_relative_error", a.median_relative_error},
                      {"worst_factor", a.worst_factor},
                      {"points_with_scatter", a.with_scatter},
                      {"inside_scatter", a.inside},
                      {"band_meets_scatter", a.band_meets}};
}

}  // namespace gonogo::lab
