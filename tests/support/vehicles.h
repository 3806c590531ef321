// Shipped vehicles, whole and with one thing changed.
#pragma once
#include <string>

#include "base/files/file.h"
#include "tests/support/catch.h"
#include "tests/support/temporary_folder.h"
#include "vehicle/model/vehicle.h"

namespace gonogo::test {

inline std::string vehicle_path(const std::string& name) {
  return std::string(GONOGO_SOURCE_DIR) + "/configs/vehicles/" + name + ".json";
}

inline vehicle::Vehicle shipped_vehicle(const std::string& name) { return vehicle::read_vehicle(vehicle_path(name)); }

/// A shipped vehicle whose file has `from` replaced by `to` where it stands first.
inline vehicle::Vehicle changed_vehicle(const std::string& name, const std::string& from, const std::string& to) {
  const TemporaryFolder folder;
  std::string text = read_file(vehicle_path(name));
  const auto at = text.find(from);
  REQUIRE(at != std::string::npos);
  write_file_atomically(folder / "changed.json", text.replace(at, from.size(), to));
  return vehicle::read_vehicle(folder / "changed.json");
}

}  // namespace gonogo::test
