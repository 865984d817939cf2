#pragma once
/// Suites of tests for every type of a list.
#include <gtest/gtest.h>

#include "math/type_list.h"

namespace rubble::test {

/// Types of a TypeList as TYPED_TEST_SUITE takes them.
template <class List> struct AsTypes;
template <class... F> struct AsTypes<TypeList<F...>> { using Types = ::testing::Types<F...>; };

}  // namespace rubble::test
