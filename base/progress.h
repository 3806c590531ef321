// Long work: its progress on stderr, and Ctrl-C, which sets a flag that it polls where stopping loses nothing.
#pragma once
#include <chrono>
#include <csignal>
#include <cstddef>
#include <string>

namespace gonogo {

/// SIGINT and SIGTERM set the flag; a second one ends the process at once.
void install_cancel_handler();

bool cancel_requested();

/// Throws Cancelled when the user asked to stop. Call between trials, blocks or epochs.
void stop_if_cancelled();

/// For a call inside a host program that handles SIGINT itself, such as Python: SIGINT sets the flag while the scope
/// lives. Its end restores the host's handler and clears the flag. Not for two scopes at once.
class CancelScope {
 public:
  CancelScope();
  ~CancelScope();
  CancelScope(const CancelScope&) = delete;
  CancelScope& operator=(const CancelScope&) = delete;

 private:
  struct sigaction host_;
};

/// How far work is, for the time it will still take.
struct Pace {
  std::size_t total = 0, done = 0, reused = 0;  // items; `reused` of the `done` ones took no time in this run
  double elapsed = 0;                           // [s] since the start of this run
  double other_elapsed = 0, other_to_come = 0;  // [s] of work that is not done item by item
};
/// [s]; NaN as long as this run has finished no item.
double seconds_left(const Pace& pace);

/// One line redrawn on a terminal, a plain line every few seconds otherwise.
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
  /// Time that goes into other work than items: so far, and still to come [s].
  void count_other_work(double elapsed, double to_come);
  /// Prints a line at once: what begins now may take long. `note` as in update().
  void announce(const std::string& note);

  /// Prints the closing line with the time taken. The destructor calls it if nobody did.
  void finish();

 private:
  void print(bool last);

  std::string task_, unit_, note_;
  std::size_t total_, done_ = 0, reused_ = 0;
  double other_elapsed_ = 0, other_to_come_ = 0;
  bool terminal_, finished_ = false;
  std::chrono::steady_clock::time_point start_, last_print_;
};

/// One plain status line on stderr: "task: message".
void log_line(const std::string& task, const std::string& message);

}  // namespace gonogo
