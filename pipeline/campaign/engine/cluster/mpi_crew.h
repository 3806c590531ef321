// The MPI engine: rank 0 coordinates, the other ranks are its workers. The same lines travel as between processes.
#pragma once
#include <memory>

#include "pipeline/campaign/engine/worker.h"

namespace gonogo::campaign {

/// From MPI_Init to MPI_Finalize; one per process. Its destructor on rank 0 stops all workers at once.
class MpiJob {
 public:
  MpiJob();
  ~MpiJob();
  MpiJob(const MpiJob&) = delete;
  MpiJob& operator=(const MpiJob&) = delete;

  int rank() const { return rank_; }
  int size() const { return size_; }

  /// For rank 0. Throws InputError when there is no other rank.
  CrewMaker crew_maker() const;
  /// For the other ranks.
  std::unique_ptr<WorkerLine> worker_line() const;

 private:
  int rank_ = 0, size_ = 1;
};

}  // namespace gonogo::campaign
