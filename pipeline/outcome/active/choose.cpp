#include "pipeline/outcome/active/choose.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/math/random.h"
#include "pipeline/campaign/design/sobol.h"

namespace gonogo::outcome {
namespace {

constexpr double kNovel = 2;                                // novelty above which a point counts as far from all trials
constexpr std::uint64_t kStartStream = 0x6163740000000000;  // random stream for the start of systematic sampling

/// Points of the scrambled Sobol' sequence in the sampled box: [count x variable count].
std::vector<double> candidates_of(const campaign::DesignSpec& spec, std::uint64_t first, std::uint64_t count) {
  std::vector<double> points;
  points.reserve(count * spec.fixed.size());
  for (std::uint64_t i = 0; i < count; ++i) {
    std::vector<double> point = spec.fixed;
    for (std::size_t j = 0; j < spec.ranges.size(); ++j) {
      const campaign::SampledVariable& range = spec.ranges[j];
      point[range.variable] =
          range.minimum +
          (range.maximum - range.minimum) * campaign::scrambled_sobol(std::uint32_t(first + i), spec.seed, int(j));
    }
    points.insert(points.end(), point.begin(), point.end());
  }
  return points;
}

}  // namespace

ModelAnswers answers_of(const Predictor& predictor) {
  return {.p_go = [&](std::span<const double> points, std::span<double> p) { predictor.p_go(points, p); },
          .novelty = [&](std::span<const double> point) { return predictor.novelty(point); }};
}

ModelAnswers answers_of(const Forecast& forecast) {
  return {.p_go =
              [&](std::span<const double> points, std::span<double> p) {
                const std::vector<double> answers = forecast.p_go({points.begin(), points.end()});
                std::copy(answers.begin(), answers.end(), p.begin());
              },
          .novelty = [](std::span<const double>) { return 1.0; }};
}

std::vector<double> choice_densities(const ModelAnswers& model, std::span<const double> points, std::size_t width,
                                     double space_filling) {
  const std::size_t count = points.size() / width;
  std::vector<double> p(count), density(count);
  model.p_go(points, p);
  double mean = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double unsure = 4 * p[i] * (1 - p[i]);
    density[i] = unsure * unsure + (model.novelty(points.subspan(i * width, width)) > kNovel ? 1 : 0);
    mean += density[i] / double(count);
  }
  for (double& d : density) d = mean > 0 ? space_filling + (1 - space_filling) * d / mean : 1;
  return density;
}

std::vector<campaign::DesignPoint> choose_batch(const campaign::DesignSpec& spec, const ModelAnswers& model,
                                                const BatchRequest& request) {
  if (spec.ranges.empty()) throw InputError("the design samples no variable; give the range of at least one");
  const std::size_t width = spec.fixed.size();
  const std::uint64_t count = std::max(request.candidates, 4 * request.count);
  const std::vector<double> points = candidates_of(spec, request.skip, count);
  const std::vector<double> density = choice_densities(model, points, width, request.space_filling);
  double sum = 0;
  for (const double d : density) sum += d;
  // Takes one point in each of `request.count` equal parts of the running sum, so a candidate is taken as often as its
  // density says. Neighbours in the sequence are taken together only where the density is far above the mean.
  const double part = sum / double(request.count);
  double next = part * random_unit(spec.seed, kStartStream, request.skip), running = 0;
  std::vector<campaign::DesignPoint> batch;
  for (std::uint64_t i = 0; i < count && batch.size() < request.count; ++i) {
    running += density[i];
    if (running <= next) continue;
    next += part;
    campaign::DesignPoint& point = batch.emplace_back();
    point.variables.assign(points.begin() + std::ptrdiff_t(i * width),
                           points.begin() + std::ptrdiff_t((i + 1) * width));
    point.proposal_density = density[i];
  }
  return batch;
}

double expected_error(const campaign::DesignSpec& spec, const ModelAnswers& model, std::uint64_t samples) {
  const std::vector<double> points = candidates_of(spec, 0, samples);
  std::vector<double> p(samples);
  model.p_go(points, p);
  double sum = 0;
  for (const double value : p) sum += std::min(value, 1 - value);
  return sum / double(samples);
}

}  // namespace gonogo::outcome
