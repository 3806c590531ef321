// How well predictions agree with what was measured.
#pragma once
#include <string>
#include <vector>

#include "base/json/json.h"

namespace gonogo::lab {

/// One quantity at one point. A prediction that could not be made is NaN.
struct ComparedValue {
  double measured = 0, predicted = 0;
  double scatter = 0;        // of the experiment, either way; 0: not known
  double load = 0;           // on the wheel [N]
  double low = 0, high = 0;  // band of the prediction over what is assumed
};

/// Over the points. NaN where a prediction is missing, as long as one point has one.
struct Agreement {
  int points = 0;
  double rms = 0;            // root-mean-square of predicted - measured, in the quantity's unit
  double bias = 0;           // mean of predicted - measured
  double rms_over_load = 0;  // the same as shares of each point's load
  double bias_over_load = 0;
  double median_relative_error = 0;  // |predicted / measured - 1|, over points measured above 1e-9 in size
  double worst_factor = 0;           // max of predicted / measured and its inverse; infinity where signs differ
  int with_scatter = 0, inside = 0;  // points with a known scatter; of them, predicted inside it
  int band_meets = 0;                // of them, where the prediction's band overlaps the experiment's scatter
};

/// A missing prediction makes all numbers NaN: no number hides a point.
Agreement agreement_of(const std::vector<ComparedValue>& values);

/// rms, rms_over_load, median_relative_error, worst_factor: what bounds are set on.
const std::vector<std::string>& measure_names();
double measure_of(const Agreement& a, const std::string& name);

Json as_json(const Agreement& a);

}  // namespace gonogo::lab
