// Mobility index and vehicle cone index: the smallest rating cone index of fine-grained soil that carries a vehicle for
// one pass or for fifty. The published formulas take pounds and inches. Inputs here are SI; the indices are in psi by
// definition.
//
// Sources: Priddy & Willoughby, "Clarification of vehicle cone index with reference to mean maximum pressure",
// J. Terramechanics 43 (2006): VCI1 of wheels and the deflection correction; Kennedy & Rush, "Development of revised
// mobility index formula for self-propelled wheeled vehicles in fine-grained soils", WES TR 3-783 (1968) and US Army FM
// 5-430-00-1 (1994), both by two public transcriptions: the factors, wheeled and tracked. VCI50 of wheels is from
// transcriptions of the same reports. VCI1 and VCI50 of tracks come from one transcription
// without a second source; the M113's published 17 and 40 psi check them.
#pragma once
#include "vehicle/model/vehicle.h"

namespace gonogo::vehicle {

/// Factors of a mobility index, in the order of its formula:
///   wheels  (contact_pressure weight / (tyre_or_track grouser) + load - clearance) engine transmission
struct MobilityFactors {
  double contact_pressure = 0, weight = 0, tyre_or_track = 0, grouser = 1, load = 0, clearance = 0, engine = 1,
         transmission = 1;
  double index() const {
    return (contact_pressure * weight / (tyre_or_track * grouser) + load - clearance) * engine * transmission;
  }
};

struct WheeledIndexInput {
  double axle_load = 0;  // [N]
  int tyres_per_axle = 2;
  double diameter = 0, section_width = 0;  // nominal, of a tyre [m]
  double clearance = 0;                    // [m]
  double power_per_mass = 0;               // [W/kg]
  bool automatic = true, chains = false;
};
MobilityFactors mobility_factors(const WheeledIndexInput& in);

struct TrackedIndexInput {
  double weight = 0;                    // [N]
  double ground_length = 0, width = 0;  // of one track [m]
  int road_wheels = 0;                  // of both tracks, on the ground
  double shoe_area = 0;                 // [m^2]
  double grouser_height = 0;            // [m]
  double clearance = 0;                 // [m]
  double power_per_mass = 0;            // [W/kg]
  bool automatic = true;
};
MobilityFactors mobility_factors(const TrackedIndexInput& in);

struct VehicleConeIndex {
  double one_pass = 0, fifty_passes = 0;  // [psi]
};

/// Factor of the indices of wheels: (0.15 / deflection_ratio)^(1/4), with the deflection over the section height.
double deflection_correction(double deflection_ratio);
VehicleConeIndex wheeled_cone_index(double mobility_index, double deflection_ratio);
VehicleConeIndex tracked_cone_index(double mobility_index);

/// Index of a vehicle file: of its most demanding axle, or of its tracks.
struct VehicleIndex {
  std::string axle;  // empty for tracks
  MobilityFactors factors;
  double deflection_ratio = 0;  // of tyres; 0.15 when the file gives none
  bool deflection_given = false;
  VehicleConeIndex cone_index{};
};

/// Throws InputError for a single-wheel rig and for wheels whose file gives no nominal tyre size.
VehicleIndex vehicle_index(const Vehicle& v);

}  // namespace gonogo::vehicle
