#include "pipeline/map/evaluate/soft_soil.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/line.h"
#include "base/units.h"
#include "terrain/soil/strength.h"
#include "terrain/soil/texture.h"

namespace gonogo::map {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// Number in psi, as cone indices are quoted.
std::string in_psi(double pascal) { return line("%.0f psi", pascal / kPsi); }

double estimated_index(const std::vector<double>& point) {
  const double cohesion = point[campaign::contract().variable_index("cohesion")];
  const double angle = point[campaign::contract().variable_index("friction_angle")];
  return terrain::cone_index(cohesion * 1e3, angle);  // NaN if one of them is not known
}

std::string texture_text(const Region& region, const Soil& soil) {
  const std::string& texture = soil.texture.empty() ? region.texture : soil.texture;
  if (!soil.given) return "where it is loam or finer";
  return texture.empty() ? line("a friction angle below %g degrees", kMinAngleOfSand) : texture;
}

/// Cone indices of the soft points of a soil.
struct Weakness {
  double least = std::numeric_limits<double>::infinity(), most = 0;  // index of soft points [Pa]
  std::size_t weak = 0, unclear = 0;                                 // points

  void add(double index) {
    if (std::isnan(index)) {
      ++unclear;
      return;
    }
    ++weak;
    least = std::min(least, index);
    most = std::max(most, index);
  }
};

std::vector<std::string> sentences(const Weakness& found, std::size_t points, const std::string& texture,
                                   const std::optional<ConeIndexNeed>& need) {
  const auto of_all = [&](std::size_t count) {
    return count == points ? std::string() : line(", %.0f %% of its points", 100.0 * double(count) / double(points));
  };
  if (!need && found.weak + found.unclear > 0)
    return {"fine-grained (" + texture + "), and no vehicle is given to compare its cone index with" +
            of_all(found.weak + found.unclear)};
  std::vector<std::string> because;
  if (found.weak > 0) {
    const std::string least = in_psi(found.least), most = in_psi(found.most);
    because.push_back("fine-grained (" + texture + ") with a cone index of " +
                      (least == most ? least : least + " to " + most) + " where " + need->vehicle + " needs " +
                      in_psi(need->fifty_passes) + " (VCI50)" + of_all(found.weak));
  }
  if (found.unclear > 0)
    because.push_back("fine-grained (" + texture + ") with a unknown cohesion or friction angle" +
                      of_all(found.unclear));
  return because;
}

}  // namespace

std::optional<bool> is_fine_grained(const Region& region, const Soil& soil) {
  std::optional<bool> fine;
  for (const SoilSample& sample : soil.samples)
    if (!sample.texture.empty()) fine = fine.value_or(false) || terrain::is_fine_grained(sample.texture);
  if (fine) return fine;
  const std::string& texture = soil.texture.empty() ? region.texture : soil.texture;
  if (texture.empty()) return std::nullopt;
  return terrain::is_fine_grained(texture);
}

SoftPoints soft_points(const Region& region, const Soil& soil, const std::vector<std::vector<double>>& points,
                       const std::optional<ConeIndexNeed>& need) {
  const std::size_t angle = campaign::contract().variable_index("friction_angle");
  const std::size_t draws = points.size() / std::max<std::size_t>(1, soil.samples.size());
  const std::optional<bool> fine = is_fine_grained(region, soil);
  SoftPoints soft{std::vector<char>(points.size(), 0), {}};
  Weakness found;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const SoilSample* sample = soil.samples.empty() ? nullptr : &soil.samples[i / draws];
    const bool known = sample && !sample->texture.empty();
    if (known ? !terrain::is_fine_grained(sample->texture) : !fine.value_or(points[i][angle] < kMinAngleOfSand))
      continue;
    const std::optional<double> measured = sample ? sample->cone_index : std::nullopt;
    const double index = measured ? *measured : estimated_index(points[i]);
    if (need && index >= need->fifty_passes) continue;
    soft.is_soft[i] = 1;
    found.add(need ? index : kUnknown);
  }
  soft.because = sentences(found, points.size(), texture_text(region, soil), need);
  return soft;
}

}  // namespace gonogo::map
