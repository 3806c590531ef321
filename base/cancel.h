// Ctrl-C sets a flag. Long work polls it where stopping loses nothing.
#pragma once

namespace gonogo {

/// SIGINT and SIGTERM set the flag; a second one ends the process at once.
void install_cancel_handler();

bool cancel_requested();

/// Throws Cancelled when the user asked to stop. Call between trials, blocks or epochs.
void stop_if_cancelled();

}  // namespace gonogo
