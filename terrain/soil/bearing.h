// What plates carry on soil of a given strength, by limit analysis, and plates that contradict a strength.
#pragma once
#include <optional>
#include <string>

#include "terrain/soil/soil.h"

namespace gonogo::terrain {

/// Least and most pressure that a plate may show on a soil [Pa].
struct BearingRange {
  double least, most;
};

/// Of a plate whose base lies `depth` below the surface [m], on soil that weighs `unit_weight` [N/m^3]. `soil`:
/// strength of triaxial compression. `width` is Bekker's b [m]: the smaller side, or the radius of a disc.
///
/// Most: general shear of a square plate 2 b wide, by the sum of the bearing capacities of cohesion (Prandtl), of
/// overburden (Reissner) and of weight, 1.5 (N_q - 1) tan(phi) (Hansen 1970, "A revised and extended formula for
/// bearing capacity", Danish Geotechnical Institute, Bulletin 28), with the shape factor 1 + N_q / N_c (De Beer 1970)
/// and Hansen's depth factors. Least: a long plate b wide on soil that does not dilate, whose strength is that on the
/// plane of shear (Davis 1968), and that is compressed before it slides: two thirds of its cohesion and of tan(phi)
/// (Terzaghi 1943, local shear), half of the weight's term and no factors.
BearingRange bearing_range(const MacroscopicSoil& soil, double unit_weight, double width, double depth);

/// One sentence where plates of this state contradict the strength that its first test shows; nothing where they do
/// not, or the state has no plates. `table` gives the triaxial angle; without one the formulas of strength.h do.
/// Sinkages of 2, 5 and 10 cm are held against bearing_range() at the plates' widths, 0.1 m if they are not given. A
/// contradiction is more than two errors beyond that range: those of the angle (1 degree, or the range's), of cohesion
/// and of the plates' pressure (a tenth each, or the range's), and 0.15 of the formula's logarithm (its sum is up to 30
/// % too small: Davis and Booker 1971 by Martin 2005).
std::optional<std::string> plates_against_strength(const SoilState& state, const Calibration* table = nullptr);

}  // namespace gonogo::terrain
