// A D-Wave 2X in software: graph with dead qubits, coefficient ranges and steps, control errors, susceptibility, an
// effective temperature, readout errors. A sampler like any other, for problems on its qubits.
//
// Error sizes: D-Wave, "QPU errors" (docs.dwavequantum.com, quantum_research/errors), whose numbers are of the 2X, near
// the freeze-out of single spins. The effective temperature is a setting; its default is the single-qubit temperature
// that D-Wave states for Advantage systems, 0.2 in units of h. Rows are Boltzmann rows of the disturbed problem, made
// by heat-bath annealing: what the machine's dynamics adds to that is not modelled.
#pragma once
#include "learning/hardware/unembed.h"
#include "learning/qubo/sapi.h"
#include "learning/sampler/sampler.h"

namespace gonogo::learning {

struct DeviceErrors {
  double h_mean = -0.013, h_deviation = 0.010;    // error of each h, drawn for every programming
  double j_mean = -0.0075, j_deviation = 0.0095;  // of each J
  double flux_deviation = 0.005;                  // slow noise on h, one draw per programming
  double h_scale_deviation = 0.01;  // of a qubit's own h scale; belongs to the device, not the programming
  double susceptibility = -0.015;   // h -> h + chi J h, J -> J + chi J J off the diagonal
  double h_step_low = 0.0164, h_step_high = 0.001;  // step of the converters at h = -2 and h = 2
  double j_step_low = 0.009, j_step_high = 0.0005;  // at J = -1 and J = 1
  double readout = 0.001;                           // chance that a qubit is read wrongly
  static DeviceErrors none();
};

struct Device {
  HardwareGraph graph;
  CoefficientRanges ranges{};
  DeviceErrors errors{};
  double temperature = 0.2;  // rows follow exp(-E' / temperature), E' the disturbed problem
  bool auto_scale = false;   // true: every problem is scaled to the full range first, which changes its temperature
  std::uint64_t serial = 1;  // seed of what belongs to the device
};

/// C12 with `dead_share` of its qubits dead.
Device d_wave_2x(double dead_share = 0.02, std::uint64_t serial = 1);

/// The solver definition under which the device's problems and answers travel.
SapiSolver solver_of(const Device& device);

/// The problem that the device effectively has after programming number `programming`.
Problem disturbed(const Problem& ising, const Device& device, std::uint64_t programming);

class Emulator final : public Sampler {
 public:
  explicit Emulator(Device device);
  std::string name() const override { return "emulator"; }
  /// Labels must be working qubits and couplings couplers, coefficients in range; throws InputError otherwise. Energies
  /// are those of the problem as given. info: temperature, auto_scale_factor, timing [us].
  SampleSet sample(const Problem& problem, const SampleRequest& request) const override;
  /// The same answer as SAPI serves it: rows by energy; histogram: equal rows counted.
  std::string answer(const Problem& problem, const SampleRequest& request, bool histogram) const;
  const Device& device() const { return device_; }

 private:
  Device device_;
  SapiSolver solver_;
};

}  // namespace gonogo::learning
