// Chooses the next points of a study. They are drawn where the model is least certain or far from all trials; a share
// is uniform over the box.
#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "pipeline/campaign/design/design.h"
#include "pipeline/outcome/answer/predictor.h"
#include "pipeline/outcome/prior/forecast.h"

namespace gonogo::outcome {

/// A model's answers. points: [count x variable count of the contract], row by row. p_go: [count].
struct ModelAnswers {
  std::function<void(std::span<const double> points, std::span<double> p_go)> p_go;
  /// Distance to the nearest trial, as Predictor::novelty(): about 1 where trials are as dense as on average.
  std::function<double(std::span<const double> point)> novelty;
};

/// Both must outlive their answers. A forecast knows no trial, so that no point is far from the others.
ModelAnswers answers_of(const Predictor& predictor);
ModelAnswers answers_of(const Forecast& forecast);

struct BatchRequest {
  std::uint64_t count = 32;         // points to choose
  double space_filling = 0.25;      // share of the points that is uniform over the box [0, 1]
  std::uint64_t skip = 0;           // points of the Sobol' sequence that earlier batches used as candidates
  std::uint64_t candidates = 4096;  // points of the sequence to choose from
};

/// Density of the choice at points [count x width], row by row: see choose_batch(). The mean over the points is 1.
std::vector<double> choice_densities(const ModelAnswers& model, std::span<const double> points, std::size_t width,
                                     double space_filling);

/// Draws points of the box of `spec` from the density
///   q(x) = space_filling + (1 - space_filling) w(x) / mean w,   w = (4 p (1 - p))^2 + [novelty above 2],
/// relative to the uniform one; p is the model's P(go). Systematic sampling over scrambled Sobol' candidates keeps the
/// points apart. Every point stores q as its proposal density. Throws InputError if `spec` samples no variable.
std::vector<campaign::DesignPoint> choose_batch(const campaign::DesignSpec& spec, const ModelAnswers& model,
                                                const BatchRequest& request);

/// Mean of min(p, 1 - p) over the box, in [0, 0.5]: the share of wrong answers that the model itself expects. A study
/// that asks for 95 % confidence continues until it is at most 0.05.
double expected_error(const campaign::DesignSpec& spec, const ModelAnswers& model, std::uint64_t samples = 4096);

}  // namespace gonogo::outcome
