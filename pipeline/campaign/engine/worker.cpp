#include "pipeline/campaign/engine/worker.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>

#include "base/error.h"
#include "base/hash.h"
#include "base/version.h"
#include "pipeline/campaign/dataset/row.h"
#include "pipeline/campaign/engine/journal.h"

namespace gonogo::campaign {
namespace {

/// Points come by standard input, results leave by a descriptor of their own.
class StandardLine : public WorkerLine {
 public:
  explicit StandardLine(int results) : results_(results) {}

  std::optional<std::string> next(bool wait) override {
    for (;;) {
      if (const std::size_t end = buffer_.find('\n'); end != std::string::npos) {
        const std::string line = buffer_.substr(0, end);
        buffer_.erase(0, end + 1);
        return line;
      }
      if (at_end_ || !(wait || is_ready(STDIN_FILENO, POLLIN))) return std::nullopt;
      receive();
    }
  }

  /// Goes on receiving meanwhile: the coordinator may be writing, too, and neither may wait for the other.
  void send(const std::string& line) override {
    for (std::size_t done = 0; done < line.size();) {
      if (!is_ready(results_, POLLOUT) && !at_end_ && is_ready(STDIN_FILENO, POLLIN)) receive();
      ssize_t count = ::send(results_, line.data() + done, line.size() - done, MSG_DONTWAIT | MSG_NOSIGNAL);
      if (count < 0 && errno == ENOTSOCK) count = ::write(results_, line.data() + done, line.size() - done);
      if (count >= 0)
        done += std::size_t(count);
      else if (errno == EAGAIN)
        wait_for_change();
      else if (errno != EINTR)
        throw DeviceError(std::string("campaign worker: cannot reach the coordinator: ") + std::strerror(errno));
    }
  }

 private:
  static bool is_ready(int fd, short events) {
    pollfd one{fd, events, 0};
    return ::poll(&one, 1, 0) > 0;
  }

  void wait_for_change() const {
    pollfd ends[] = {{results_, POLLOUT, 0}, {STDIN_FILENO, POLLIN, 0}};
    ::poll(ends, at_end_ ? 1 : 2, -1);
  }

  void receive() {
    char bytes[4096];
    const ssize_t count = ::read(STDIN_FILENO, bytes, sizeof bytes);
    if (count < 0 && errno == EINTR) return;
    if (count <= 0)
      at_end_ = true;
    else
      buffer_.append(bytes, std::size_t(count));
  }

  int results_;
  bool at_end_ = false;
  std::string buffer_;
};

std::string one_line(std::string sentence) {
  std::replace(sentence.begin(), sentence.end(), '\n', ' ');
  return sentence;
}

DesignPoint point_in(const std::string& line) {
  const std::optional<std::string_view> row = unseal_line(line);
  const std::optional<DesignPoint> point = row ? parse_point(*row) : std::nullopt;
  if (!point) throw InputError("campaign worker: its input holds no design points; it is started by a campaign");
  return *point;
}

/// Fills the engine and takes it one step on; false when nothing is left to do.
bool work(WorkerLine& line, TrialEngine& engine) {
  if (line.is_cancelled()) return false;
  while (engine.has_room()) {
    const std::optional<std::string> next = line.next(!engine.is_running());
    if (!next) break;
    engine.start(point_in(*next));
  }
  if (!engine.is_running()) return false;
  for (const TrialRecord& record : engine.advance()) line.send(kTrialWord + seal_line(to_row(record)));
  return true;
}

class OneAtATime : public TrialEngine {
 public:
  explicit OneAtATime(const TrialFunction& trial) : trial_(trial) {}
  bool has_room() const override { return !point_; }
  bool is_running() const override { return point_.has_value(); }
  void start(const DesignPoint& point) override { point_ = point; }
  std::vector<TrialRecord> advance() override {
    const DesignPoint point = *point_;
    point_.reset();
    return {trial_(point)};
  }

 private:
  const TrialFunction& trial_;
  std::optional<DesignPoint> point_;
};

}  // namespace

std::string worker_program() {
  return std::string(program_version()) + " (" + program_revision() + "), contract " + content_hash(contract_text());
}

void run_worker(TrialEngine& engine, WorkerLine& line) {
  try {
    line.send(kHelloWord + seal_line(worker_program()));
    while (work(line, engine)) {
    }
  } catch (const InputError& error) {
    line.send(kRefusedWord + seal_line(one_line(error.what())));
  } catch (const DeviceError& error) {
    line.send(kFailedWord + seal_line(one_line(error.what())));
  }
}

void run_worker(TrialEngine& engine) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  std::signal(SIGINT, SIG_IGN);  // Ctrl-C is the coordinator's to handle
  std::signal(SIGTERM, SIG_DFL);
  StandardLine line(::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1));
  ::dup2(STDERR_FILENO, STDOUT_FILENO);
  run_worker(engine, line);
}

void run_worker(const TrialFunction& trial, WorkerLine& line) {
  OneAtATime engine(trial);
  run_worker(engine, line);
}

void run_worker(const TrialFunction& trial) {
  OneAtATime engine(trial);
  run_worker(engine);
}

}  // namespace gonogo::campaign
