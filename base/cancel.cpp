#include "base/cancel.h"

#include <csignal>

#include "base/error.h"

namespace gonogo {
namespace {

volatile std::sig_atomic_t requested = 0;

void request(int signal) {
  requested = 1;
  std::signal(signal, SIG_DFL);
}

}  // namespace

void install_cancel_handler() {
  std::signal(SIGINT, request);
  std::signal(SIGTERM, request);
}

bool cancel_requested() { return requested != 0; }

void stop_if_cancelled() {
  if (cancel_requested()) throw Cancelled();
}

}  // namespace gonogo
