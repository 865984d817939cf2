/// Rows of joints in exactly solved joint trees.
#include <forces/joint_tree.h>

#include "tests/forces/joint_cases.h"

namespace rubble::RUBBLE_CORE {
namespace {

/// Rows at the angle of a hinge whose A is rotated by 1 rad. Its unloaded limit is at 1 rad + `ahead`.
TreePart<2> rowsAtLimit(Real ahead, TreeSolve how) {
  constexpr int kAngle = 2;
  StepConstants c = testConstants();
  JointSpec<HingeJoint> spec{};
  Joint<HingeJoint> joint{};
  const Pose a{{0, 0, 0}, fromAxisAngle(Vec3{1, 0, 0}, Real(1))}, b{{0, 0, 0}, Quat{}};
  joint.memory.remember(spec.data, a, b, {});
  Real angle[1];
  TwistAxis::constraint(spec.data, joint.memory, a, b, angle);
  AxisSpec& limits = partOf<kAngle>(spec.parts);
  limits = {-kNoLimit, angle[0] + ahead, kHardValue, 0, 0, 0, 0, 0, kHardValue, 0, 0, 0, 0};
  beginAxis(c, limits, partOf<kAngle>(joint.parts), {angle[0], 0, 0, 0, 1, 1, 1, kHardValue, 1});
  TreePart<2> rows{};
  findTreePart<HingeJoint, kAngle, TwistAxis>(c, spec, joint, a, b, how, rows);
  return rows;
}

TEST(TreeRows, ALimitReachedByASolveStaysActiveInTheNextOneOnEitherSide) {
  for (const Real off : {-1e-7, 1e-7}) {
    const TreePart<2> rows = rowsAtLimit(off, TreeSolve::Again);
    ASSERT_EQ(rows.count, 1) << off;
    EXPECT_EQ(rows.row[0].take, TreeTake::UpperLimit) << off;
    EXPECT_GT(rows.row[0].hessian, 0) << off;
  }
}

TEST(TreeRows, ALimitThatIsNotReachedIsFree) {
  EXPECT_EQ(rowsAtLimit(1e-7, TreeSolve::Exact).count, 0)
      << "in the first solve its side of the limit decides";
  EXPECT_EQ(rowsAtLimit(1e-3, TreeSolve::Again).count, 0) << "nor is one held that is really open";
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
