#pragma once
/// Variants of the kernels that sum constraints, by the kinds of constraints that occur.
#include "backend/cuda/tile.cuh"

namespace rubble::RUBBLE_CORE {

/// Lanes per body in sweeps: few where bodies fill the device, so that reductions are short, and more
/// otherwise, so that a body takes fewer rounds.
inline constexpr int kLeastLanes = 4, kMostLanes = 16;

/// Which constraints occur besides contacts without rolling friction. Their calls cost registers in the whole
/// kernel.
enum class ExtraRows { None, Any, FewJoints };
/// While bodies do not fill the device, the time of all joints is that of one.
inline bool hasFewJoints(const SolverData& s, int threads) {
  return s.hasJoints() && lanesFor<1, kMostLanes>(s.bodies, threads) == kMostLanes;
}
inline ExtraRows extraRowsOf(const SolverData& s, int threads) {
  if (hasFewJoints(s, threads)) return ExtraRows::FewJoints;
  return s.hasJoints() || s.rolls || s.vertices > 0 || s.anyKinds ? ExtraRows::Any : ExtraRows::None;
}
/// Calls f.operator()<extra>().
template <class F> void withExtraRows(ExtraRows extra, F&& f) {
  switch (extra) {
    case ExtraRows::None:
      return f.template operator()<ExtraRows::None>();
    case ExtraRows::Any:
      return f.template operator()<ExtraRows::Any>();
    case ExtraRows::FewJoints:
      return f.template operator()<ExtraRows::FewJoints>();
  }
}

}  // namespace rubble::RUBBLE_CORE
