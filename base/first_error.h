// Exceptions may not leave a parallel loop. This keeps the first one and throws it after the loop.
#pragma once
#include <atomic>
#include <exception>
#include <mutex>

namespace gonogo {

class FirstError {
 public:
  /// Runs `work` unless a thread has already failed. Thread-safe.
  template <class Work>
  void guard(const Work& work) noexcept {
    if (failed_) return;
    try {
      work();
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!error_) error_ = std::current_exception();
      failed_ = true;
    }
  }

  /// Call after the loop.
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  std::exception_ptr error_;
  std::mutex mutex_;
  std::atomic<bool> failed_ = false;
};

}  // namespace gonogo
