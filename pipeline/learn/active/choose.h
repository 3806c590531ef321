// Where the next trials of a study teach most: points drawn where a model is least sure or has seen nothing like them,
// with a share that fills the space.
#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "pipeline/campaign/design/design.h"

namespace gonogo::learn {

/// What a model says at many points. points: [count x variable count of the contract], row by row.
struct ModelAnswers {
  std::function<void(std::span<const double> points, std::span<double> p_go)> p_go;
  /// Distance to the nearest trial over the typical distance between neighbours; about 1 where trials are usual.
  std::function<double(std::span<const double> point)> novelty;
};

struct BatchRequest {
  std::uint64_t count = 32;     // points
  double space_filling = 0.25;  // share of the points that are uniform over the box
  std::uint64_t skip = 0;       // points of the Sobol' sequence that earlier batches looked at
  std::uint64_t candidates = 4096;
};

/// Draws points of the box of `spec` from the density
///   q(x) = space_filling + (1 - space_filling) w(x) / mean w,   w = (4 p (1 - p))^2 + [novelty above 2],
/// relative to uniform, with p the model's P(go): by systematic sampling over scrambled Sobol' candidates, which keeps
/// the points apart. Each point stores its q as its proposal density. Throws InputError for a box with nothing sampled.
std::vector<campaign::DesignPoint> choose_batch(const campaign::DesignSpec& spec, const ModelAnswers& model,
                                                const BatchRequest& request);

/// Mean of min(p, 1 - p) over the box: the share of wrong answers that the model itself expects; 0 when it is sure
/// everywhere. A study that asks for 95 % confidence goes on until this is at most 0.05.
double expected_error(const campaign::DesignSpec& spec, const ModelAnswers& model, std::uint64_t samples = 4096);

}  // namespace gonogo::learn
