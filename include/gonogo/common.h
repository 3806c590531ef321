// Shared by all headers of include/gonogo: errors, vectors, named values, files that ship.
//
// Public names live in namespace gonogo::api; all else in the library's archives is internal and may change, and so are
// Impl and impl() of classes. Units are SI and radians unless a comment says otherwise. A function that takes a file
// throws InputError when it cannot use it.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace gonogo::api {

/// What was given cannot be used. The sentence says file, place, value, allowed range and remedy.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// A library, the operating system or a device refused. The sentence names the call.
struct DeviceError : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// Ctrl-C after cancel_on_interrupt(). Finished work is kept.
struct Cancelled : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct Vec3 {
  double x = 0, y = 0, z = 0;
};

/// Rotation from a body's axes to the world's; unit length.
struct Quat {
  double w = 1, x = 0, y = 0, z = 0;
};

/// From low to high, both included.
struct Range {
  double low = 0, high = 0;
  double middle() const { return (low + high) / 2; }
};

/// Numbers by name, such as {{"slope_along", 12}}; variables() of campaign.h lists names and units.
using Values = std::map<std::string, double>;

/// What computes: the threads of this process, or a CUDA device. Both are deterministic, with different bits.
enum class Device { cpu, cuda };

/// Release, "0.2.0". Headers and archives of one minor version go together.
std::string version();
/// Git revision of the archives.
std::string revision();

/// Names of what ships: `kind` is "vehicles", "soils", "studies", "regions" or "models". Files are found by name in
/// configs/ and data/ below the current folder, in $GONOGO_SHARE, and in the prefix or source tree of the program.
std::vector<std::string> shipped(const std::string& kind);

/// From now on Ctrl-C and SIGTERM make the long call that runs throw Cancelled; a second one ends the process.
void cancel_on_interrupt();

}  // namespace gonogo::api
