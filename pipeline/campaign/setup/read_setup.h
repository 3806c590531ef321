// Setups of trials: as a study says, or for a vehicle and a soil without a study; and values of a single trial's
// variables, for one that no design has drawn.
#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "pipeline/campaign/setup/setup.h"
#include "pipeline/campaign/study/study.h"

namespace gonogo::campaign {

/// Reads the study's vehicle and its sections "soil" and "trial". Packings are cached in `packing_folder`. Throws
/// InputError for anything out of range, also when the ranges of "design" exceed the calibration's reach.
TrialSetup read_trial_setup(const Study& study, const std::filesystem::path& packing_folder = default_packing_folder(),
                            sim::Backend device = sim::Backend::cpu);

/// Setup without a study: a vehicle's file and a calibration's. A whole vehicle gets tiles of bed that are wide and
/// long enough, a moving patch, and two of its lengths or the task's obstacle to cover. Numerics are the table's
/// (terrain::numerics_by_table) where `asked` sets none.
TrialSetup vehicle_trial_setup(const std::filesystem::path& vehicle, const std::filesystem::path& calibration,
                               std::shared_ptr<const TrialTask> task = default_task(),
                               const terrain::AskedNumerics& asked = {},
                               const std::filesystem::path& packing_folder = default_packing_folder());

/// [variable] The study's fixed values and the middles of its ranges; NaN where its points come from a file.
std::vector<double> middle_values(const Study& study);

/// [variable] Level ground and soil of the middle friction angle that the calibration reaches, at 1.5 m/s.
std::vector<double> usual_values(const TrialSetup& setup);

/// Sets a variable of the contract. Throws InputError, beginning with `where`, for an unknown name and for a value
/// outside the variable's range.
void set_value(std::vector<double>& values, const std::string& name, double value, const std::string& where);

/// Throws InputError, beginning with `where`, that names the first variable without a value.
void check_all_given(const std::vector<double>& values, const std::string& where);

}  // namespace gonogo::campaign
