#include "base/progress.h"

#include <unistd.h>
#include <cmath>
#include <cstdio>

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
  std::signal(SIGXFSZ, SIG_IGN);  // a limit on file sizes then fails the write, which is told in a sentence
  sigset_t signals;               // a program that this one replaced may have held them back
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  sigprocmask(SIG_UNBLOCK, &signals, nullptr);
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

namespace {

using Seconds = std::chrono::duration<double>;

std::string clock_time(double seconds) {
  char text[32];
  if (seconds < 60)
    std::snprintf(text, sizeof text, "%.0f s", seconds);
  else
    std::snprintf(text, sizeof text, "%d:%02d min", int(seconds) / 60, int(seconds) % 60);
  return text;
}

std::string bar(double fraction) {
  constexpr int width = 24;
  std::string text = "[";
  for (int i = 0; i < width; ++i) text += i < fraction * width ? '#' : '.';
  return text + "]";
}

}  // namespace

double seconds_left(const Pace& pace) {
  const double items = double(pace.done) - double(pace.reused), spent = pace.elapsed - pace.other_elapsed;
  if (items <= 0 || spent <= 0) return NAN;
  return double(pace.total - pace.done) * spent / items + pace.other_to_come;
}

Progress::Progress(std::string task, std::string unit, std::size_t total)
    : task_(std::move(task)),
      unit_(std::move(unit)),
      total_(total),
      terminal_(::isatty(STDERR_FILENO) != 0),
      start_(std::chrono::steady_clock::now()),
      last_print_(start_) {}

Progress::~Progress() { finish(); }

void Progress::update(std::size_t done, const std::string& note, std::size_t reused) {
  done_ = done;
  note_ = note;
  reused_ = reused;
  const auto now = std::chrono::steady_clock::now();
  const double interval = terminal_ ? 0.1 : 10.0;
  if (Seconds(now - last_print_).count() < interval) return;
  last_print_ = now;
  print(false);
}

void Progress::make_room() {
  if (!terminal_) return;
  std::fputs("\r\033[K", stderr);
  last_print_ = {};
}

void Progress::count_other_work(double elapsed, double to_come) {
  other_elapsed_ = elapsed;
  other_to_come_ = to_come;
}

void Progress::announce(const std::string& note) {
  note_ = note;
  last_print_ = std::chrono::steady_clock::now();
  print(false);
}

void Progress::finish() {
  if (finished_) return;
  finished_ = true;
  print(true);
}

void Progress::print(bool last) {
  const double elapsed = Seconds(std::chrono::steady_clock::now() - start_).count();
  const double at_items = elapsed - other_elapsed_, rate = at_items > 0 ? double(done_ - reused_) / at_items : 0;
  const double left = seconds_left({total_, done_, reused_, elapsed, other_elapsed_, other_to_come_});
  std::string line = task_ + ": ";
  if (terminal_ && total_ > 0 && !last) line += bar(double(done_) / double(total_)) + " ";
  line += std::to_string(done_) + (total_ > 0 ? "/" + std::to_string(total_) : "") + " " + unit_;
  char text[64];
  if (rate > 0) {
    std::snprintf(text, sizeof text, ", %.3g/s", rate);
    line += text;
  }
  if (last)
    line += ", " + clock_time(elapsed);
  else if (left > 0 && total_ > done_)
    line += ", " + clock_time(left) + " left";
  if (!note_.empty()) line += ", " + note_;
  std::fprintf(stderr, terminal_ ? "\r\033[K%s%s" : "%s%s", line.c_str(), terminal_ && !last ? "" : "\n");
}

void log_line(const std::string& task, const std::string& message) {
  std::fprintf(stderr, "%s: %s\n", task.c_str(), message.c_str());
}

}  // namespace gonogo
