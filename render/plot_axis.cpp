#include "render/plot_axis.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace rubble::render {

double Axis::at(double value) const {
  if (logarithmic)
    return (std::log10(std::max(value, low)) - std::log10(low)) / (std::log10(high) - std::log10(low));
  return (value - low) / (high - low);
}

Axis linearAxis(double low, double high, int count) {
  if (!(high > low)) high = low + (low == 0 ? 1 : std::fabs(low) * .1);
  const double rough = (high - low) / count, decade = std::pow(10, std::floor(std::log10(rough)));
  double step = decade;
  for (const double factor : {1., 2., 5., 10.}) {
    step = factor * decade;
    if (step >= rough * .999) break;
  }
  Axis axis;
  axis.low = step * std::floor(low / step + 1e-9);
  axis.high = step * std::ceil(high / step - 1e-9);
  const int ticks = static_cast<int>(std::lround((axis.high - axis.low) / step));
  for (int i = 0; i <= ticks; ++i) axis.ticks.push_back(axis.low + i * step);
  return axis;
}

Axis logAxis(double low, double high) {
  Axis axis;
  axis.logarithmic = true;
  int first = static_cast<int>(std::floor(std::log10(low) + 1e-9)),
      last = static_cast<int>(std::ceil(std::log10(high) - 1e-9));
  if (first == last) ++last;
  for (int decade = first; decade <= last; ++decade) axis.ticks.push_back(std::pow(10., decade));
  axis.low = axis.ticks.front();
  axis.high = axis.ticks.back();
  return axis;
}

std::string tickText(double value) {
  const double size = std::fabs(value);
  char text[32];
  if (size != 0 && (size < 1e-3 || size >= 1e6)) {
    const int decade = static_cast<int>(std::floor(std::log10(size) + 1e-9));
    std::snprintf(text, sizeof text, "%.3ge%d", value / std::pow(10., decade), decade);
    return text;
  }
  std::snprintf(text, sizeof text, size >= 1000 ? "%.0f" : "%.4g", value);
  std::string digits = text;
  if (digits == "-0") digits = "0";
  const int begin = digits[0] == '-' ? 1 : 0;
  for (int at = static_cast<int>(digits.size()) - 3; at > begin && size >= 1000; at -= 3)
    digits.insert(static_cast<std::size_t>(at), ",");
  return digits;
}

}  // namespace rubble::render
