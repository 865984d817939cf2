#pragma once
/// Orders points by recursive bisection, so that neighbors in space are neighbors in the list.
#include <algorithm>
#include <numeric>
#include <vector>

#include <rubble/math.h>

namespace rubble {

/// Orders the indices [begin, end) into pieces of at most `most`, by bisecting the longest side of their
/// bounding box at the median. Calls visit(begin, end) for each piece. at(index): position of a point.
template <class At, class Visit>
void cutInHalves(std::vector<int>& order, int begin, int end, int most, const At& at, const Visit& visit) {
  if (end - begin <= most) {
    visit(begin, end);
    return;
  }
  Vec3 low = at(order[static_cast<std::size_t>(begin)]), high = low;
  for (int k = begin; k < end; ++k)
    for (int i = 0; i < 3; ++i) {
      const double x = at(order[static_cast<std::size_t>(k)])[i];
      low[i] = std::min(low[i], x), high[i] = std::max(high[i], x);
    }
  const Vec3 size = high - low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0
                   : size.y >= size.z                   ? 1
                                                        : 2,
            middle = (begin + end) / 2;
  std::nth_element(order.begin() + begin, order.begin() + middle, order.begin() + end, [&](int a, int b) {
    return at(a)[axis] != at(b)[axis] ? at(a)[axis] < at(b)[axis] : a < b;
  });
  cutInHalves(order, begin, middle, most, at, visit);
  cutInHalves(order, middle, end, most, at, visit);
}

/// Orders all points. Used for the corners of a body, so that contact owners have neighbors in the list
/// (stages/soft/body_corners.h).
inline std::vector<int> nearOrder(const std::vector<Vec3>& points) {
  std::vector<int> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  cutInHalves(
      order, 0, static_cast<int>(points.size()), 1,
      [&](int i) -> const Vec3& { return points[static_cast<std::size_t>(i)]; }, [](int, int) {});
  return order;
}

}  // namespace rubble
