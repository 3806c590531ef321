// Ranks that compute one thing together and exchange bytes: processes of an MPI job (mpi.h), or threads of one process.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <type_traits>
#include <vector>

#include "base/error.h"

namespace gonogo {

/// Bytes for another rank or from it.
struct Letter {
  int rank = 0;
  void* data = nullptr;
  std::size_t bytes = 0;
};

/// One of the ranks, as it sees the others. All call the same functions in the same order.
class Ranks {
 public:
  virtual ~Ranks() = default;
  virtual int rank() const = 0;
  virtual int count() const = 0;
  /// Whether they are threads of one process.
  virtual bool share_memory() const = 0;

  /// Sends letters and waits for others. Two ranks agree on the number, order and sizes of the letters between them.
  /// Throws DeviceError when a rank is lost.
  virtual void exchange(std::span<const Letter> sent, std::span<const Letter> received) = 0;
};

/// The only one of its kind.
class LoneRank final : public Ranks {
 public:
  int rank() const override { return 0; }
  int count() const override { return 1; }
  bool share_memory() const override { return true; }
  void exchange(std::span<const Letter>, std::span<const Letter>) override {}
};

template <class T>
Letter letter(int rank, std::vector<T>& items) {
  static_assert(std::is_trivially_copyable_v<T>);
  return {rank, items.data(), items.size() * sizeof(T)};
}

/// Sends `own` to all others. In: the sizes of what the others send, `all[r]`, where r is not this rank. Out: `all`,
/// with `own` in its place.
template <class T>
void share(Ranks& ranks, std::vector<T> own, std::vector<std::vector<T>>& all) {
  GONOGO_ASSERT(int(all.size()) == ranks.count());
  std::vector<Letter> sent, received;
  for (int r = 0; r < ranks.count(); ++r) {
    if (r == ranks.rank()) continue;
    sent.push_back(letter(r, own));
    received.push_back(letter(r, all[std::size_t(r)]));
  }
  ranks.exchange(sent, received);
  all[std::size_t(ranks.rank())] = std::move(own);
}

/// What each rank gives, by rank; sizes may differ.
template <class T>
std::vector<std::vector<T>> gathered(Ranks& ranks, std::vector<T> own) {
  std::vector<std::vector<std::uint64_t>> size(std::size_t(ranks.count()), std::vector<std::uint64_t>(1));
  share(ranks, {std::uint64_t(own.size())}, size);
  std::vector<std::vector<T>> all(size.size());
  for (std::size_t r = 0; r < all.size(); ++r) all[r].resize(size[r][0]);
  share(ranks, std::move(own), all);
  return all;
}

/// The same, one after the other.
template <class T>
std::vector<T> joined(Ranks& ranks, std::vector<T> own) {
  std::vector<T> one;
  for (const std::vector<T>& part : gathered(ranks, std::move(own))) one.insert(one.end(), part.begin(), part.end());
  return one;
}

/// Runs work(ranks) in `count` threads of this process. Throws what one of them threw first; the others then end in
/// their next exchange.
void run_in_threads(int count, const std::function<void(Ranks&)>& work);

}  // namespace gonogo
