#pragma once
/// The muscle of MuJoCo: curves of force over length and speed, in units of optimal length
/// (https://mujoco.readthedocs.io/en/stable/modeling.html#muscle-actuators).
#include <algorithm>

namespace rubble::convert {

struct MuscleCurves {
  double shortest = 0.5, longest = 1.6, fastest = 1.5, passive = 1.3, lengthening = 1.2;

  /// Active force at an isometric length, over the peak force.
  double active(double length) const {
    const double a = (shortest + 1) / 2, b = (1 + longest) / 2;
    const auto half = [](double x) { return x * x / 2; };
    if (length <= shortest || length >= longest) return 0;
    if (length <= a) return half((length - shortest) / (a - shortest));
    if (length <= 1) return 1 - half((1 - length) / (1 - a));
    if (length <= b) return 1 - half((length - 1) / (b - 1));
    return half((longest - length) / (longest - b));
  }
  /// Passive force, over the peak force.
  double stretched(double length) const {
    const double b = (1 + longest) / 2;
    if (length <= 1) return 0;
    if (length <= b) return passive * (length - 1) * (length - 1) / ((b - 1) * (b - 1)) / 2;
    return passive * (0.5 + (length - b) / (b - 1));
  }
};

}  // namespace rubble::convert
