#pragma once
/// Ticks of axes.
#include <string>
#include <vector>

namespace rubble::render {

struct Axis {
  double low = 0, high = 1;
  bool logarithmic = false;
  std::vector<double> ticks;

  /// 0 to 1 along the axis.
  double at(double value) const;
};

/// A linear axis with about `count` round ticks over [low, high].
Axis linearAxis(double low, double high, int count = 5);
/// An axis of whole decades over [low, high]; both above 0.
Axis logAxis(double low, double high);
/// 0.001 -> "0.001", 1e-6 -> "1e-6", 12000 -> "12,000".
std::string tickText(double value);

}  // namespace rubble::render
