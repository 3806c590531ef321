// Which numerics trials take whose soil is met through a calibration table.
#pragma once
#include <optional>

#include "terrain/bed/numerics.h"
#include "terrain/soil/calibration.h"

namespace gonogo::terrain {

/// What is asked for in so many words; the rest is the table's.
struct AskedNumerics {
  std::optional<double> step;  // [s]
  std::optional<int> substeps, iterations;
  std::optional<double> tolerance;  // [m/s]
  std::optional<sim::Target> target;

  /// Nothing is left for the table to say.
  bool complete() const { return step && substeps && iterations && tolerance && target; }
};

/// A friction angle belongs to the numerics that it was measured with (docs/soils.md): those in the table's provenance,
/// with what is asked for in their place, by options or by a study's `trial.numerics`.
/// Throws InputError where the table does not say its numerics and not all of them are asked for; `file` names the
/// table in that sentence.
Numerics numerics_by_table(const Calibration& table, const std::filesystem::path& file,
                           const AskedNumerics& asked = {});

}  // namespace gonogo::terrain
