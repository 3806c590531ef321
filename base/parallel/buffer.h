// Arrays in host or GPU memory: views that kernels take, and buffers that own. GPU memory is allocated only here.
#pragma once
#include <algorithm>
#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include "base/error.h"
#include "base/math/vec.h"

#ifdef __CUDACC__
#include <cuda_runtime.h>
#endif

namespace gonogo {

/// Non-owning array for kernels: a pointer and a count, in host or device memory.
template <class T>
struct View {
  T* data = nullptr;
  Index size = 0;

  GONOGO_HD T& operator[](Index i) const {
    GONOGO_ASSERT(i >= 0 && i < size);
    return data[i];
  }
  GONOGO_HD T* begin() const { return data; }
  GONOGO_HD T* end() const { return data + size; }
  /// To View<const T>.
  template <class U>
  requires(std::is_same_v<U, const T> && !std::is_const_v<T>) GONOGO_HD operator View<U>() const {
    return {data, size};
  }
};

/// Runs on the host with this many threads.
struct Cpu {
  int threads = 1;
};

/// Runs on the current GPU in this stream (cudaStream_t; void* so that host code can hold it).
struct Cuda {
  void* stream = nullptr;
  const Index* halted = nullptr;  // on the device: kernels do nothing while it is not zero
  void* side = nullptr;           // second stream, see SideStream in for_each.h
  Index side_count = 0;
};

/// Takes no memory: counts the bytes that a GPU's buffers of the same sizes take.
struct Tally {
  static inline thread_local std::size_t bytes = 0;  // of all buffers of this thread
};

#ifdef __CUDACC__
inline void check_cuda(cudaError_t status, const char* call) {
  if (status != cudaSuccess) throw DeviceError(std::string("CUDA ") + call + ": " + cudaGetErrorString(status));
}
#endif

template <class T, class Exec>
class Buffer;

template <class T>
class Buffer<T, Cpu> {
 public:
  Buffer() = default;
  explicit Buffer(std::size_t size) : items_(size) {}
  Index size() const { return Index(items_.size()); }
  T* data() { return items_.data(); }
  View<T> view() { return {items_.data(), size()}; }
  /// Old elements keep their values; new ones are zero.
  void resize(std::size_t size) { items_.resize(size); }
  void fill_zero(std::size_t size) { items_.assign(size, T{}); }
  void upload(const std::vector<T>& from) { items_ = from; }
  std::vector<T> download() const { return items_; }
  std::vector<T> download(Index begin, Index count) const {
    return {items_.begin() + begin, items_.begin() + begin + count};
  }
  T read(Index i) const { return items_[i]; }
  void write(Index i, const T& value) { items_[i] = value; }
  void write(Index begin, const std::vector<T>& from) { std::copy(from.begin(), from.end(), items_.begin() + begin); }
  void swap(Buffer& other) { items_.swap(other.items_); }

 private:
  std::vector<T> items_;
};

/// Grows as the buffer on a GPU does; what is written into it is lost.
template <class T>
class Buffer<T, Tally> {
 public:
  Buffer() = default;
  ~Buffer() { Tally::bytes -= capacity_ * sizeof(T); }
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;

  Index size() const { return Index(size_); }
  View<T> view() { return {nullptr, size()}; }
  void resize(std::size_t size) {
    if (size > capacity_) {
      const std::size_t capacity = std::max(size, capacity_ + capacity_ / 2);
      Tally::bytes += (capacity - capacity_) * sizeof(T);
      capacity_ = capacity;
    }
    size_ = size;
  }
  void fill_zero(std::size_t size) { resize(size); }
  void upload(const std::vector<T>& from) { resize(from.size()); }
  void write(Index, const T&) {}

 private:
  std::size_t size_ = 0, capacity_ = 0;
};

#ifdef __CUDACC__
template <class T>
class Buffer<T, Cuda> {
 public:
  Buffer() = default;
  explicit Buffer(std::size_t size) { resize(size); }
  ~Buffer() { cudaFree(data_); }
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;
  Buffer(Buffer&& other) noexcept { swap(other); }
  Buffer& operator=(Buffer&& other) noexcept {
    swap(other);
    return *this;
  }

  Index size() const { return Index(size_); }
  T* data() { return data_; }
  View<T> view() { return {data_, size()}; }

  /// Grows to at least 1.5 times the capacity when it must grow; new memory is zero. OutOfMemory names the bytes
  /// wanted.
  void resize(std::size_t size) {
    if (size > capacity_) {
      const std::size_t capacity = std::max(size, capacity_ + capacity_ / 2);
      T* grown = nullptr;
      if (cudaMalloc(&grown, capacity * sizeof(T)) != cudaSuccess) refuse(capacity * sizeof(T));
      check_cuda(cudaMemset(grown, 0, capacity * sizeof(T)), "clear");
      if (size_ > 0) check_cuda(cudaMemcpy(grown, data_, size_ * sizeof(T), cudaMemcpyDeviceToDevice), "copy");
      cudaFree(data_);
      data_ = grown;
      capacity_ = capacity;
    } else if (size > size_) {
      check_cuda(cudaMemset(data_ + size_, 0, (size - size_) * sizeof(T)), "clear");
    }
    size_ = size;
  }
  void fill_zero(std::size_t size) {
    resize(size);
    if (size > 0) check_cuda(cudaMemset(data_, 0, size * sizeof(T)), "clear");
  }
  void upload(const std::vector<T>& from) {
    resize(from.size());
    if (!from.empty())
      check_cuda(cudaMemcpy(data_, from.data(), from.size() * sizeof(T), cudaMemcpyHostToDevice), "upload");
  }
  std::vector<T> download() const {
    std::vector<T> to(size_);
    if (size_ > 0) check_cuda(cudaMemcpy(to.data(), data_, size_ * sizeof(T), cudaMemcpyDeviceToHost), "download");
    return to;
  }
  std::vector<T> download(Index begin, Index count) const {
    std::vector<T> to(count);
    if (count > 0)
      check_cuda(cudaMemcpy(to.data(), data_ + begin, count * sizeof(T), cudaMemcpyDeviceToHost), "download");
    return to;
  }
  T read(Index i) const {
    T value;
    check_cuda(cudaMemcpy(&value, data_ + i, sizeof(T), cudaMemcpyDeviceToHost), "read");
    return value;
  }
  void write(Index i, const T& value) {
    check_cuda(cudaMemcpy(data_ + i, &value, sizeof(T), cudaMemcpyHostToDevice), "write");
  }
  void write(Index begin, const std::vector<T>& from) {
    if (!from.empty())
      check_cuda(cudaMemcpy(data_ + begin, from.data(), from.size() * sizeof(T), cudaMemcpyHostToDevice), "write");
  }
  void swap(Buffer& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(capacity_, other.capacity_);
  }

 private:
  [[noreturn]] static void refuse(std::size_t bytes) {
    cudaGetLastError();  // else the next kernel's check would find this error
    std::size_t unused = 0, total = 0;
    cudaMemGetInfo(&unused, &total);
    throw OutOfMemory("out of GPU memory: " + std::to_string(bytes) + " bytes asked for, " + std::to_string(unused) +
                      " of " + std::to_string(total) + " are free; use fewer worlds or a smaller bed");
  }

  T* data_ = nullptr;
  std::size_t size_ = 0, capacity_ = 0;
};
#endif

}  // namespace gonogo
