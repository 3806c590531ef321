// Emulator of a D-Wave 2X: graph with dead qubits, ranges and steps of coefficients, control errors, susceptibility,
// effective temperature, readout errors. It is a Sampler of problems on its qubits.
//
// Error sizes: D-Wave, "QPU errors" (docs.dwavequantum.com, quantum_research/errors), measured on the 2X near the
// freeze-out of single spins. The default effective temperature, 0.2 in units of h, is the single-qubit temperature
// that D-Wave states for Advantage systems. Rows are Boltzmann samples of the disturbed problem by heat-bath annealing.
// The machine's dynamics are not modelled.
#pragma once
#include "learning/formats/sapi.h"
#include "learning/qubits/unembed.h"
#include "learning/sampler/sampler.h"

namespace gonogo::learning {

struct DeviceErrors {
  double h_mean = -0.013, h_deviation = 0.010;      // error of each h, drawn for every programming
  double j_mean = -0.0075, j_deviation = 0.0095;    // of each J
  double flux_deviation = 0.005;                    // slow noise on h, one draw per programming
  double h_scale_deviation = 0.01;                  // of each qubit's h scale; fixed for the device
  double susceptibility = -0.015;                   // h -> h + chi J h, J -> J + chi J J off the diagonal
  double h_step_low = 0.0164, h_step_high = 0.001;  // step of the converters at h = -2 and h = 2
  double j_step_low = 0.009, j_step_high = 0.0005;  // at J = -1 and J = 1
  double readout = 0.001;                           // probability of a readout error per qubit
  static DeviceErrors none();
};

struct Device {
  HardwareGraph graph;
  CoefficientRanges ranges{};
  DeviceErrors errors{};
  double temperature = 0.2;  // rows follow exp(-E' / temperature), with the disturbed energy E'
  bool auto_scale = false;   // true: problems are scaled to the full range first, which changes their temperature
  std::uint64_t serial = 1;  // seed of all that is fixed for the device
};

/// Chimera C12 with `dead_share` of its qubits dead.
Device d_wave_2x(double dead_share = 0.02, std::uint64_t serial = 1);

/// The device as a SAPI solver.
SapiSolver solver_of(const Device& device);

/// The disturbed problem after programming number `programming`.
Problem disturbed(const Problem& ising, const Device& device, std::uint64_t programming);

class Emulator final : public Sampler {
 public:
  explicit Emulator(Device device);
  std::string name() const override { return kEmulator; }
  /// Throws InputError unless labels are working qubits, couplings are couplers, and coefficients are in range.
  /// Energies are those of the given problem. info: temperature, auto_scale_factor, timing [us].
  SampleSet sample(const Problem& problem, const SampleRequest& request) const override;
  /// The same answer in SAPI's form, rows sorted by energy. histogram: equal rows are counted.
  std::string answer(const Problem& problem, const SampleRequest& request, bool histogram) const;
  const Device& device() const { return device_; }

 private:
  Device device_;
  SapiSolver solver_;
};

}  // namespace gonogo::learning
