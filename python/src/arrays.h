// Arrays of numpy over memory of C++.
#pragma once
#include <nanobind/ndarray.h>

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

namespace gonogo::python {

template <class T>
using Array = nanobind::ndarray<nanobind::numpy, T>;
/// In memory of any device: numpy, torch, cupy and jax take it by from_dlpack().
template <class T>
using DeviceArray = nanobind::ndarray<nanobind::array_api, T>;
template <class T, int Dimensions>
using ArrayIn = nanobind::ndarray<const T, nanobind::ndim<Dimensions>, nanobind::c_contig, nanobind::device::cpu>;

/// The vector becomes the array's memory.
template <class T>
Array<T> array_of(std::vector<T>&& values, std::initializer_list<std::size_t> shape) {
  auto* owner = new std::vector<T>(std::move(values));
  nanobind::capsule free_it(owner, [](void* p) noexcept { delete static_cast<std::vector<T>*>(p); });
  return Array<T>(owner->data(), shape, free_it);
}
template <class T>
Array<T> array_of(std::vector<T>&& values) {
  const std::size_t count = values.size();
  return array_of(std::move(values), {count});
}

/// Component `first` and those after it of every record in `records`: a view, kept valid by `owner`.
template <class T, class Record>
Array<const T> field_of(const std::vector<Record>& records, const T* first, std::size_t width, nanobind::handle owner) {
  static_assert(sizeof(Record) % sizeof(T) == 0);
  const std::size_t shape[] = {records.size(), width};
  const std::int64_t strides[] = {sizeof(Record) / sizeof(T), 1};
  return Array<const T>(first, width > 1 ? 2 : 1, shape, owner, strides);
}

inline std::vector<double> vector_of(const ArrayIn<double, 1>& array) {
  return std::vector<double>(array.data(), array.data() + array.size());
}

}  // namespace gonogo::python
