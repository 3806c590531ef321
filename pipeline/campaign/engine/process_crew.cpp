#include "pipeline/campaign/engine/process_crew.h"

#include <poll.h>

#include <cerrno>
#include <cstring>

#include "base/error.h"
#include "pipeline/campaign/engine/worker_process.h"

namespace gonogo::campaign {
namespace {

class ProcessCrew : public Crew {
 public:
  ProcessCrew(std::size_t size, WorkerCommand command) : command_(std::move(command)), workers_(size) {}

  std::size_t size() const override { return workers_.size(); }

  void send(std::size_t worker, const std::string& line) override {
    if (!workers_[worker]) workers_[worker] = std::make_unique<WorkerProcess>(command_(worker));
    workers_[worker]->send(line);
  }

  std::vector<CrewNews> wait(int milliseconds) override {
    std::vector<pollfd> lines;
    std::vector<std::size_t> owner;
    for (std::size_t i = 0; i < workers_.size(); ++i) {
      if (!workers_[i]) continue;
      lines.push_back({workers_[i]->fd(), POLLIN, 0});
      owner.push_back(i);
    }
    if (::poll(lines.data(), lines.size(), milliseconds) < 0) {
      if (errno == EINTR) return {};
      throw DeviceError(std::string("campaign: cannot wait for the workers: ") + std::strerror(errno));
    }
    std::vector<CrewNews> news;
    for (std::size_t i = 0; i < lines.size(); ++i)
      if (lines[i].revents != 0) news.push_back(hear(owner[i]));
    return news;
  }

 private:
  CrewNews hear(std::size_t number) {
    std::unique_ptr<WorkerProcess>& worker = workers_[number];
    CrewNews news;
    news.worker = number;
    news.gone = !worker->receive();
    while (std::optional<std::string> line = worker->take_line()) news.lines.push_back(std::move(*line));
    if (!news.gone) return news;
    const int status = worker->wait_for_end();
    news.killed_from_outside = killed_from_outside(status);
    news.end = describe_end(status);
    worker.reset();
    return news;
  }

  WorkerCommand command_;
  std::vector<std::unique_ptr<WorkerProcess>> workers_;
};

}  // namespace

std::unique_ptr<Crew> process_crew(std::size_t size, WorkerCommand command) {
  return std::make_unique<ProcessCrew>(size, std::move(command));
}

}  // namespace gonogo::campaign
