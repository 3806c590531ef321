#include "base/cancel.h"

#include "base/error.h"

namespace gonogo {
namespace {

volatile std::sig_atomic_t requested = 0;

void request(int signal) {
  requested = 1;
  std::signal(signal, SIG_DFL);
}

void request_again_and_again(int) { requested = 1; }

}  // namespace

void install_cancel_handler() {
  std::signal(SIGINT, request);
  std::signal(SIGTERM, request);
}

bool cancel_requested() { return requested != 0; }

void stop_if_cancelled() {
  if (cancel_requested()) throw Cancelled();
}

CancelScope::CancelScope() {
  struct sigaction ours = {};
  ours.sa_handler = request_again_and_again;
  sigemptyset(&ours.sa_mask);
  sigaction(SIGINT, &ours, &host_);
}

CancelScope::~CancelScope() {
  sigaction(SIGINT, &host_, nullptr);
  requested = 0;
}

}  // namespace gonogo
