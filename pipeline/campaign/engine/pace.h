// Speed of a campaign, written for other processes into small files beside it. Each file has a span of its own clock,
// so that clocks of two machines are never compared.
#pragma once
#include <chrono>
#include <filesystem>
#include <string>

namespace gonogo::campaign {

/// One writer's file, removed at the end. Failures are ignored: the file serves `campaign status` alone.
class PaceWriter {
 public:
  PaceWriter(const std::filesystem::path& folder, const std::string& writer);
  ~PaceWriter();
  PaceWriter(const PaceWriter&) = delete;
  PaceWriter& operator=(const PaceWriter&) = delete;

  void trial_done() { ++done_; }
  /// Writes at most every two seconds; call often.
  void tell_if_due();

 private:
  std::filesystem::path path_;
  std::size_t done_ = 0;
  std::chrono::steady_clock::time_point start_, last_;
};

/// Trials per second of all writers together [1/s]; 0 when there is none.
double total_pace(const std::filesystem::path& folder);

/// Removes files of writers that were killed. Needs the coordinator's lock.
void forget_paces(const std::filesystem::path& folder);

}  // namespace gonogo::campaign
