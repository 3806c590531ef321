// A small study with its own small region, to be broken in one place.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "base/json/json.h"
#include "tests/support/temporary_folder.h"

namespace gonogo {

extern const char* const kProjectedWkt;   // metres
extern const char* const kGeographicWkt;  // degrees

/// study.json with six short trials, its calibration and vehicle; region.json and elevation.asc with .prj: a ramp that
/// steepens from 0 to 35 degrees. Change `study` or `region`, then write().
class StudyFolder {
 public:
  StudyFolder();

  Json study, region;

  void write() const;
  std::filesystem::path path(const std::string& name) const { return folder_ / name; }
  std::filesystem::path out() const { return folder_ / "out"; }
  std::vector<std::string> run_words() const { return {"run", path("study.json"), "--out", out(), "--threads", "2"}; }
  void make_readable_for_all() const;

 private:
  TemporaryFolder folder_;
};

}  // namespace gonogo
