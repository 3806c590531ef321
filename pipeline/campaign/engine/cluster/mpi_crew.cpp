#include "pipeline/campaign/engine/cluster/mpi_crew.h"

#include <mpi.h>
#include <unistd.h>

#include <chrono>

#include "base/error.h"

namespace gonogo::campaign {
namespace {

constexpr int kLine = 1, kStop = 2;  // tags
constexpr useconds_t kPause = 200;   // [us] between looks: MPI's own waiting keeps a core busy
constexpr std::chrono::hours kForEver(24 * 365);

/// A message from `source` (or anybody) within `patience`, or nothing.
struct Message {
  int source = 0, tag = 0;
  std::string text;
};

std::optional<Message> receive(int source, std::chrono::steady_clock::duration patience) {
  const auto end = std::chrono::steady_clock::now() + patience;
  for (;;) {
    int there = 0;
    MPI_Status status;
    MPI_Iprobe(source, MPI_ANY_TAG, MPI_COMM_WORLD, &there, &status);
    if (there) {
      int bytes = 0;
      MPI_Get_count(&status, MPI_CHAR, &bytes);
      Message message{status.MPI_SOURCE, status.MPI_TAG, std::string(std::size_t(bytes), '\0')};
      MPI_Recv(message.text.data(), bytes, MPI_CHAR, message.source, message.tag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
      return message;
    }
    if (std::chrono::steady_clock::now() >= end) return std::nullopt;
    ::usleep(kPause);
  }
}

void send_text(int rank, int tag, const std::string& text) {
  MPI_Send(text.data(), int(text.size()), MPI_CHAR, rank, tag, MPI_COMM_WORLD);
}

/// A rank that dies takes the whole job with it (MPI's own rule); the same command continues the campaign.
class MpiCrew : public Crew {
 public:
  explicit MpiCrew(std::size_t size) : size_(size) {}
  std::size_t size() const override { return size_; }
  void send(std::size_t worker, const std::string& line) override { send_text(int(worker) + 1, kLine, line); }
  std::vector<CrewNews> wait(int milliseconds) override {
    std::vector<CrewNews> news;
    auto patience = std::chrono::steady_clock::duration(std::chrono::milliseconds(milliseconds));
    while (std::optional<Message> message = receive(MPI_ANY_SOURCE, patience)) {
      CrewNews& heard = news.emplace_back();
      heard.worker = std::size_t(message->source) - 1;
      heard.lines.push_back(message->text.substr(0, message->text.find('\n')));
      patience = {};
    }
    return news;
  }

 private:
  std::size_t size_;
};

class MpiLine : public WorkerLine {
 public:
  std::optional<std::string> next(bool wait) override {
    if (stopped_) return std::nullopt;
    const auto patience = wait ? std::chrono::steady_clock::duration(kForEver) : std::chrono::steady_clock::duration{};
    const std::optional<Message> message = receive(0, patience);
    if (!message) return std::nullopt;
    stopped_ = message->tag == kStop;
    if (stopped_) return std::nullopt;
    return message->text.substr(0, message->text.find('\n'));
  }
  void send(const std::string& line) override { send_text(0, kLine, line); }
  bool is_cancelled() override {
    if (stopped_) return true;
    int there = 0;
    MPI_Iprobe(0, kStop, MPI_COMM_WORLD, &there, MPI_STATUS_IGNORE);
    return there != 0;
  }

 private:
  bool stopped_ = false;
};

}  // namespace

MpiJob::MpiJob() {
  int provided = 0;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
}

MpiJob::~MpiJob() {
  if (rank_ == 0)
    for (int worker = 1; worker < size_; ++worker) send_text(worker, kStop, "");
  MPI_Finalize();
}

CrewMaker MpiJob::crew_maker() const {
  if (size_ < 2)
    throw InputError(
        "the mpi engine needs one rank to coordinate and at least one to work: start it with mpirun -n 2 " +
        std::string("or more, or take --engine local"));
  return [workers = std::size_t(size_ - 1)](std::size_t) { return std::make_unique<MpiCrew>(workers); };
}

std::unique_ptr<WorkerLine> MpiJob::worker_line() const { return std::make_unique<MpiLine>(); }

}  // namespace gonogo::campaign
