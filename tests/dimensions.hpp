#pragma once
// Typed tests over the dimension: `constexpr int Dim = TypeParam::value`.

#include <gtest/gtest.h>

#include <type_traits>

namespace impinge {

using Dimensions = testing::Types<std::integral_constant<int, 2>, std::integral_constant<int, 3>>;

}  // namespace impinge
