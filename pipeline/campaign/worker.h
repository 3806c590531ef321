// The worker's half of a campaign: points in by standard input, trials out by standard output, one sealed line each.
#pragma once
#include <functional>
#include <string>

#include "pipeline/trial/record.h"

namespace gonogo::pipeline {

/// A trial is a pure function of the point: no matter in which process or how often it runs, it gives the same bits.
/// It throws InputError or DeviceError only for trouble that every trial would meet; the campaign stops with that
/// sentence. A failed simulation is a record with the verdict unknown.
using TrialFunction = std::function<TrialRecord(const DesignPoint&)>;

/// Computes points until standard input ends. Whatever the trial prints to standard output goes to standard error.
/// Ends with the coordinator, however that ends.
void run_worker(const TrialFunction& trial);

// Lines from worker to coordinator start with one of these words.
inline constexpr const char* kTrialWord = "trial ";
inline constexpr const char* kRefusedWord = "refused ";  // then the sentence of an InputError
inline constexpr const char* kFailedWord = "failed ";    // then the sentence of a DeviceError

}  // namespace gonogo::pipeline
