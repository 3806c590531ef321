#include "learning/rbm/regression/fit_files.h"

#include "learning/model/model.h"

namespace gonogo::learning {

namespace {

void write(Hdf5Writer& out, const std::string& path, const std::vector<double>& values, const Shape& shape,
           const char* description) {
  out.array(path, values, shape);
  out.attribute(path, "description", description);
}

void write_scaling(Hdf5Writer& out, const std::string& group, const Standardisation& scaling) {
  write(out, group + "/mean", scaling.mean, {scaling.mean.size()}, "of every input; it is taken off");
  write(out, group + "/scale", scaling.scale, {scaling.scale.size()}, "of every input, by which the rest is divided");
}

void write_parts(Hdf5Writer& out, const std::string& group, const ProcessParts& parts) {
  const std::size_t width = parts.scaling.mean.size();
  write_scaling(out, group, parts.scaling);
  write(out, group + "/logs", parts.logs, {parts.logs.size()}, "logs of the kernel's lengths, then of its variances");
  write(out, group + "/inputs", parts.inputs, {parts.slope.size(), width}, "rows, standardised");
  write(out, group + "/slope", parts.slope, {parts.slope.size()}, "weights of the rows in the latent function");
}

Standardisation read_scaling(const Hdf5Reader& in, const std::string& group) {
  Standardisation scaling{.mean = finite_array(in, group + "/mean"), .scale = {}};
  scaling.scale = finite_array(in, group + "/scale", Shape{scaling.mean.size()});
  for (const double x : scaling.scale)
    if (!(x > 0)) in.fail(group + "/scale", "holds a scale that is not above 0; train the model again");
  return scaling;
}

/// variances: logs beside those of the lengths.
ProcessParts read_parts(const Hdf5Reader& in, const std::string& group, std::size_t variances) {
  ProcessParts parts{.scaling = read_scaling(in, group)};
  const std::size_t width = parts.scaling.mean.size();
  parts.logs = finite_array(in, group + "/logs", Shape{width + variances});
  parts.slope = finite_array(in, group + "/slope");
  parts.inputs = finite_array(in, group + "/inputs", Shape{parts.slope.size(), width});
  return parts;
}

}  // namespace

void write_fit(Hdf5Writer& out, const std::string& group, const GaussianProcessModel& fit) {
  write_parts(out, group, fit.parts());
}

void write_fit(Hdf5Writer& out, const std::string& group, const GaussianRegression& fit) {
  const RegressionParts parts = fit.parts();
  write_parts(out, group, parts);
  write(out, group + "/target", {parts.mean, parts.scale}, {2}, "mean and scale of the targets");
}

void write_fit(Hdf5Writer& out, const std::string& group, const LogisticModel& fit) {
  write_scaling(out, group, fit);
  write(out, group + "/weight", fit.weight, {fit.weight.size()}, "of every input, then the constant");
}

GaussianProcessModel read_process(const Hdf5Reader& in, const std::string& group) {
  return GaussianProcessModel(read_parts(in, group, 1));
}

GaussianRegression read_regression(const Hdf5Reader& in, const std::string& group) {
  const std::vector<double> target = finite_array(in, group + "/target", Shape{2});
  return GaussianRegression({read_parts(in, group, 3), target[0], target[1]});
}

LogisticModel read_logistic(const Hdf5Reader& in, const std::string& group) {
  LogisticModel fit{read_scaling(in, group), {}};
  fit.weight = finite_array(in, group + "/weight", Shape{fit.mean.size() + 1});
  return fit;
}

}  // namespace gonogo::learning
