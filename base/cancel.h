// Ctrl-C sets a flag. Long work polls it where stopping loses nothing.
#pragma once
#include <csignal>

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

}  // namespace gonogo
