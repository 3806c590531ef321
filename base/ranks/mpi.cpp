#include "base/ranks/mpi.h"

#include <mpi.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <string>
#include <thread>

#include "base/error.h"

namespace gonogo {
namespace {

constexpr std::size_t kLongest = std::size_t(1) << 30;  // bytes of one message; MPI counts them by an int
constexpr int kTag = 7;

void check(int status, const char* call) {
  if (status == MPI_SUCCESS) return;
  char text[MPI_MAX_ERROR_STRING];
  int length = 0;
  MPI_Error_string(status, text, &length);
  throw DeviceError(std::string("MPI ") + call + ": " + std::string(text, std::size_t(length)));
}

class MpiRank final : public Ranks {
 public:
  MpiRank() {
    int initialised = 0, level = 0;
    MPI_Initialized(&initialised);
    if (!initialised) {
      check(MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &level), "initialisation");
      std::atexit([] { MPI_Finalize(); });
    }
    MPI_Comm_set_errhandler(MPI_COMM_WORLD, MPI_ERRORS_RETURN);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &count_);
  }
  int rank() const override { return rank_; }
  int count() const override { return count_; }
  bool share_memory() const override { return count_ == 1; }

  void exchange(std::span<const Letter> sent, std::span<const Letter> received) override {
    std::vector<MPI_Request> requests;
    for (const Letter& letter : received)
      for_each_message(letter, [&](void* at, int bytes) {
        check(MPI_Irecv(at, bytes, MPI_BYTE, letter.rank, kTag, MPI_COMM_WORLD, &requests.emplace_back()), "receive");
      });
    for (const Letter& letter : sent)
      for_each_message(letter, [&](void* at, int bytes) {
        check(MPI_Isend(at, bytes, MPI_BYTE, letter.rank, kTag, MPI_COMM_WORLD, &requests.emplace_back()), "send");
      });
    check(MPI_Waitall(int(requests.size()), requests.data(), MPI_STATUSES_IGNORE), "wait");
  }

 private:
  template <class Work>
  static void for_each_message(const Letter& letter, const Work& work) {
    for (std::size_t at = 0; at < letter.bytes; at += kLongest)
      work(static_cast<std::byte*>(letter.data) + at, int(std::min(kLongest, letter.bytes - at)));
  }

  int rank_ = 0, count_ = 1;
};

}  // namespace

std::unique_ptr<Ranks> mpi_ranks() { return std::make_unique<MpiRank>(); }

void end_mpi_job(int status) {
  std::this_thread::sleep_for(std::chrono::milliseconds(500));  // mpirun drops what it has not yet forwarded
  MPI_Abort(MPI_COMM_WORLD, status);
  std::_Exit(status);
}

}  // namespace gonogo
