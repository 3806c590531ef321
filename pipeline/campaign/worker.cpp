#include "pipeline/campaign/worker.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <optional>

#include "base/error.h"
#include "pipeline/campaign/journal.h"
#include "pipeline/dataset/row.h"

namespace gonogo::pipeline {
namespace {

/// The next line of standard input, or nothing at its end.
std::optional<std::string> next_line(std::string& buffer) {
  for (;;) {
    if (const std::size_t end = buffer.find('\n'); end != std::string::npos) {
      const std::string line = buffer.substr(0, end);
      buffer.erase(0, end + 1);
      return line;
    }
    char bytes[4096];
    const ssize_t count = ::read(STDIN_FILENO, bytes, sizeof bytes);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return std::nullopt;
    buffer.append(bytes, std::size_t(count));
  }
}

void send(int fd, const std::string& line) {
  for (std::size_t done = 0; done < line.size();) {
    const ssize_t count = ::write(fd, line.data() + done, line.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0)
      throw DeviceError(std::string("campaign worker: cannot reach the coordinator: ") + std::strerror(errno));
    done += std::size_t(count);
  }
}

std::string one_line(std::string sentence) {
  std::replace(sentence.begin(), sentence.end(), '\n', ' ');
  return sentence;
}

std::string answer(const TrialFunction& trial, const DesignPoint& point) {
  try {
    return kTrialWord + seal_line(to_row(trial(point)));
  } catch (const InputError& error) {
    return kRefusedWord + seal_line(one_line(error.what()));
  } catch (const DeviceError& error) {
    return kFailedWord + seal_line(one_line(error.what()));
  }
}

}  // namespace

void run_worker(const TrialFunction& trial) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  std::signal(SIGINT, SIG_IGN);  // Ctrl-C is the coordinator's to handle
  std::signal(SIGTERM, SIG_DFL);
  const int results = ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
  ::dup2(STDERR_FILENO, STDOUT_FILENO);
  std::string buffer;
  while (const std::optional<std::string> line = next_line(buffer)) {
    const std::optional<std::string_view> row = unseal_line(*line);
    const std::optional<DesignPoint> point = row ? parse_point(*row) : std::nullopt;
    if (!point) throw InputError("campaign worker: standard input holds no design points; it is started by a campaign");
    send(results, answer(trial, *point));
  }
}

}  // namespace gonogo::pipeline
