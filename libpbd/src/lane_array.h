#pragma once
// A growing array without the standard library (see lane.h). Keeps its memory when it shrinks; elements are plain data.

#include "lane_group.h"

namespace doublet::pbd {
inline namespace DOUBLET_PBD_ISA {

template <class E> class Array {
public:
  Array() = default;
  Array(const Array &) = delete;
  Array &operator=(const Array &) = delete;
  ~Array() { lane_free(data_); }

  void resize(int size) {
    if (size > capacity_)
      grow(size);
    size_ = size;
  }
  void push_back(const E &element) {
    if (size_ == capacity_)
      grow(2 * size_ + 64);
    data_[size_++] = element;
  }
  /// Room for `count` more behind the last; resize() then takes in those that are kept.
  E *spare(int count) {
    if (size_ + count > capacity_)
      grow(2 * size_ + 64 + count);
    return data_ + size_;
  }
  void clear() { size_ = 0; }
  void swap(Array &other) {
    exchange(data_, other.data_);
    exchange(size_, other.size_);
    exchange(capacity_, other.capacity_);
  }
  int size() const { return size_; }
  E *data() { return data_; }
  const E *data() const { return data_; }
  E &operator[](int i) { return data_[i]; }
  const E &operator[](int i) const { return data_[i]; }
  E *begin() { return data_; }
  E *end() { return data_ + size_; }
  const E *begin() const { return data_; }
  const E *end() const { return data_ + size_; }

private:
  template <class V> static void exchange(V &a, V &b) {
    const V kept = a;
    a = b;
    b = kept;
  }
  void grow(int capacity) {
    E *larger = static_cast<E *>(lane_allocate(static_cast<unsigned long>(capacity) * sizeof(E)));
    if (size_ > 0)
      __builtin_memcpy(static_cast<void *>(larger), data_, static_cast<unsigned long>(size_) * sizeof(E));
    lane_free(data_);
    data_ = larger;
    capacity_ = capacity;
  }
  E *data_ = nullptr;
  int size_ = 0, capacity_ = 0;
};

} // namespace DOUBLET_PBD_ISA
} // namespace doublet::pbd
