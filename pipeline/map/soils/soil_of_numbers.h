// A soil by the numbers of one test, written in one line.
#pragma once
#include <optional>
#include <string>

#include "pipeline/map/soils/soil.h"

namespace gonogo::map {

/// Points of each state of a soil that is named or not given. The same for all, so that a state gives the same answer
/// alone and among others.
inline constexpr int kSoilDraws = 32;

/// Nothing for texts that name no test before a colon. Units are deg, kPa, kN/m^(n+1), kN/m^(n+2) and mm:
///   "direct_shear:phi=31,c=0.5", the same of ring_shear, triaxial and plane_strain; "repose:phi=30"
///   "bevameter:n=1.1,k_c=0.99,k_phi=1528,c=1.04,phi=28,K=25"
///   "unconfined:strength=60,phi=10": cohesion is that of a specimen that breaks under this stress
///   "cone:index=414,soil=CL,phi=15": cohesion by cone_index() of fine-grained soil, which also counts as a measured
///   index; without phi, friction angles of 0 to 30 deg are alternatives
/// "density=0.5" (relative) and "soil=SM" (a class of the USCS or a USDA texture) may follow each. Throws InputError,
/// with an example, for numbers that are missing, unknown or out of range.
std::optional<Soil> soil_of_numbers(const std::string& text);

}  // namespace gonogo::map
