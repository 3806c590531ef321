// Progress of long work on stderr: one line redrawn on a terminal, a plain line every few seconds otherwise.
#pragma once
#include <chrono>
#include <cstddef>
#include <string>

namespace gonogo {

class Progress {
 public:
  /// `unit` is plural ("trials"); `total` may be 0 when unknown.
  Progress(std::string task, std::string unit, std::size_t total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// `reused` of the `done` items took no time in this run and do not count in the rate. `note` follows the ETA.
  void update(std::size_t done, const std::string& note = "", std::size_t reused = 0);

  /// Clears the line of a terminal, so that other output starts there; the next update draws it again.
  void make_room();

  /// Prints the closing line with the time taken. The destructor calls it if nobody did.
  void finish();

 private:
  void print(bool last);

  std::string task_, unit_, note_;
  std::size_t total_, done_ = 0, reused_ = 0;
  bool terminal_, finished_ = false;
  std::chrono::steady_clock::time_point start_, last_print_;
};

/// One plain status line on stderr: "task: message".
void log_line(const std::string& task, const std::string& message);

}  // namespace gonogo
