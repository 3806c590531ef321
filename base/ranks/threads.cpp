#include <condition_variable>
#include <cstring>
#include <deque>
#include <exception>
#include <map>
#include <mutex>
#include <thread>

#include "base/ranks/ranks.h"

namespace gonogo {
namespace {

/// Letters under way between threads, in order for each pair.
class Post {
 public:
  void send(int from, const Letter& letter) {
    const auto* begin = static_cast<const std::byte*>(letter.data);
    const std::lock_guard lock(mutex_);
    box_[{from, letter.rank}].emplace_back(begin, begin + letter.bytes);
    arrived_.notify_all();
  }

  void receive(int to, const Letter& letter) {
    std::unique_lock lock(mutex_);
    auto& box = box_[{letter.rank, to}];
    arrived_.wait(lock, [&] { return !box.empty() || closed_; });
    if (box.empty()) throw DeviceError("another rank has ended");
    GONOGO_ASSERT(box.front().size() == letter.bytes);
    if (letter.bytes > 0) std::memcpy(letter.data, box.front().data(), letter.bytes);
    box.pop_front();
  }

  /// Nothing more will arrive.
  void close(const std::exception_ptr& reason) {
    const std::lock_guard lock(mutex_);
    if (!reason_) reason_ = reason;
    closed_ = true;
    arrived_.notify_all();
  }

  void rethrow() const {
    if (reason_) std::rethrow_exception(reason_);
  }

 private:
  std::mutex mutex_;
  std::condition_variable arrived_;
  std::map<std::pair<int, int>, std::deque<std::vector<std::byte>>> box_;
  std::exception_ptr reason_;
  bool closed_ = false;
};

class ThreadRank final : public Ranks {
 public:
  ThreadRank(Post& post, int rank, int count) : post_(post), rank_(rank), count_(count) {}
  int rank() const override { return rank_; }
  int count() const override { return count_; }
  bool share_memory() const override { return true; }
  void exchange(std::span<const Letter> sent, std::span<const Letter> received) override {
    for (const Letter& letter : sent) post_.send(rank_, letter);
    for (const Letter& letter : received) post_.receive(rank_, letter);
  }

 private:
  Post& post_;
  int rank_, count_;
};

}  // namespace

void run_in_threads(int count, const std::function<void(Ranks&)>& work) {
  Post post;
  std::vector<std::thread> threads;
  for (int r = 0; r < count; ++r)
    threads.emplace_back([&, r] {
      try {
        ThreadRank ranks(post, r, count);
        work(ranks);
      } catch (...) {
        post.close(std::current_exception());
      }
    });
  for (std::thread& thread : threads) thread.join();
  post.rethrow();
}

}  // namespace gonogo
