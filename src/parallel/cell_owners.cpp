#include "impinge/parallel/cell_owners.hpp"

#include <algorithm>

namespace impinge {

template <int Dim>
int CellOwners<Dim>::operator()(std::int64_t cell) const {
  constexpr int most_known = 1 << 18;
  if (segments_.size() == 1) return segments_.front().rank;
  if (known_.size() == most_known) {
    known_.clear();
    owner_.clear();
  }
  const auto number = static_cast<std::size_t>(known_.insert(cell));
  if (number == owner_.size()) {
    const std::int64_t key = curve_.key(cells_.coordinates(cell));
    owner_.push_back(std::prev(std::ranges::upper_bound(segments_, key, {}, &Segment::first))->rank);
  }
  return owner_[number];
}

template class CellOwners<2>;
template class CellOwners<3>;

}  // namespace impinge
