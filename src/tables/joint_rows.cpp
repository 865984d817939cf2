#include "tables/joint_rows.h"

#include <algorithm>

namespace rubble::RUBBLE_CORE {

AxisTables::AxisTables(const JointRows& rows) {
  for (const EngineAxis& joint : rows.joints) joints.push_back({joint.type, joint.slot, 0});
  for (std::size_t k = 0; k < rows.axes.size(); ++k) {
    const EngineAxis& axis = rows.axes[k];
    axes.push_back({axis.type, axis.slot, axis.axis});
    for (int side = 0; side < 4; ++side)
      if (const int body = axis.bodies[static_cast<std::size_t>(side)]; body >= 0)
        sides.push_back({body, static_cast<int>(k), side});
  }
  std::ranges::sort(sides, {}, [](const AxisSide& s) { return std::array{s.body, s.axis, s.side}; });
}

}  // namespace rubble::RUBBLE_CORE
