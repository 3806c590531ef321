// Numerics of trials whose soil comes from a calibration table.
#pragma once
#include <optional>

#include "terrain/bed/numerics.h"
#include "terrain/soil/calibration.h"

namespace gonogo::terrain {

/// Numerics that the user gave; the others come from the table.
struct AskedNumerics {
  std::optional<double> step;  // [s]
  std::optional<int> substeps, iterations;
  std::optional<double> tolerance;  // [m/s]
  std::optional<sim::Target> target;
  std::optional<sim::Solver> contact{};  // complementarity or a penalty law
  std::optional<double> overlap{};       // of a penalty law, see Numerics

  /// Whether the user gave all of them.
  bool complete() const { return step && substeps && iterations && tolerance && target; }
};

/// Numerics in the table's provenance, with those that the user gave in their place. A friction angle holds only for
/// the numerics of its measurement (docs/soils.md). Throws InputError when the table does not state its numerics and
/// the user did not give all; the message names the table `file`.
Numerics numerics_by_table(const Calibration& table, const std::filesystem::path& file,
                           const AskedNumerics& asked = {});

}  // namespace gonogo::terrain
