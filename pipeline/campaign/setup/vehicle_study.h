// A study of trials for a vehicle of one's own, and what it costs.
#pragma once
#include <filesystem>
#include <string>

#include "base/json/json.h"
#include "vehicle/model/vehicle.h"

namespace gonogo::campaign {

/// Rules follow configs/studies/hmmwv_32mm.json, with lengths in wheel diameters and times in sqrt(D / g): speeds of
/// 0.4 to 1 sqrt(g D), 16 units of driving, beds of 0.13 to 0.29 D. Payloads go to a quarter of the mass. Grains are
/// the coarsest shipped ones of which 6 lie across a tread, or the finest.
struct VehicleStudy {
  Json json;         // of the study
  double grain = 0;  // diameter [m]
  double grains_per_tread = 0;
  double grains = 0;   // of a bed of middle depth
  double updates = 0;  // of all grains in a trial: steps times substeps times iterations
};

/// The coarsest shipped soil table with so many grains across a tread [m], or the finest.
std::filesystem::path coarsest_table(double tread, double grains);

/// `vehicle_file`: as the study shall name it. Throws InputError for a vehicle that does not stand by itself.
VehicleStudy study_of_vehicle(const std::filesystem::path& vehicle_file, std::size_t points, double gravity);

/// Time of so many trials here: on the GPUs of this machine, or on its cores [s].
struct StudyCost {
  double seconds = 0;
  std::string device;  // "2 cores", "4 GPUs (NVIDIA H100)"
};
StudyCost cost_of(const VehicleStudy& study, std::size_t trials);

/// "640 trials: 9 hours on 2 cores here"
std::string cost_text(const VehicleStudy& study, std::size_t trials);

}  // namespace gonogo::campaign
