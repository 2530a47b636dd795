#pragma once
// Vectors whose new entries have no value.

#include <memory>
#include <utility>
#include <vector>

namespace impinge {

/// Leaves new entries of a vector unwritten: memory beyond what is used then costs nothing.
template <class T>
struct UninitialisedAllocator : std::allocator<T> {
  template <class U>
  struct rebind {
    using other = UninitialisedAllocator<U>;
  };
  template <class U, class... Arguments>
  void construct(U* place, Arguments&&... arguments) {
    ::new (static_cast<void*>(place)) U(std::forward<Arguments>(arguments)...);
  }
  template <class U>
  void construct(U* place) {
    ::new (static_cast<void*>(place)) U;
  }
};

/// A vector whose new entries have no value.
template <class T>
using Buffer = std::vector<T, UninitialisedAllocator<T>>;

}  // namespace impinge
