/// Rows of joints as a tree that is solved exactly sees them.
#include <forces/joint_tree.h>

#include "tests/forces/joint_cases.h"

namespace rubble::RUBBLE_CORE {
namespace {

/// The angle of a hinge of which A has turned by 1 rad, with a limit at 1 rad + `ahead` that bears nothing yet. False: the row does not act.
bool rowsAtLimit(Real ahead, TreeSolve how, TreeRows<1>& rows) {
  constexpr int kAngle = 2;
  using Angle = TwistAxis;
  StepConstants c = testConstants();
  c.maxMultiplier = 1e30;
  JointSpec<HingeJoint> spec{};
  Joint<HingeJoint> joint{};
  const Pose a{{0, 0, 0}, fromAxisAngle(Vec3{1, 0, 0}, Real(1))}, b{{0, 0, 0}, Quat{}};
  joint.memory.remember(spec.data, a, b, {});
  Real angle[1];
  Angle::constraint(spec.data, joint.memory, a, b, angle);
  AxisSpec& limits = partOf<kAngle>(spec.parts);
  limits = {-kNoLimit, angle[0] + ahead, kHardValue, 0, 0, 0, 0, 0, kHardValue, 0};
  beginAxis(c, limits, partOf<kAngle>(joint.parts), {angle[0], 0, 0, 1, 1, 1, kHardValue});
  return treeRows<HingeJoint, kAngle, Angle>(c, spec, joint, a, b, how, rows);
}

TEST(TreeRows, ALimitThatASolveHasComeToHoldsInTheNextOneOnEitherSideOfIt) {
  for (const Real off : {-1e-7, 1e-7}) {
    TreeRows<1> rows{};
    ASSERT_TRUE(rowsAtLimit(off, TreeSolve::Again, rows)) << off;
    EXPECT_TRUE(rows.solved[0].there) << off;
    EXPECT_EQ(rows.solved[0].side, 1) << off;
    EXPECT_GT(rows.hessian, 0) << off;
  }
}

TEST(TreeRows, ALimitThatIsNotReachedIsFree) {
  TreeRows<1> rows{};
  EXPECT_FALSE(rowsAtLimit(1e-7, TreeSolve::Exact, rows)) << "in the first solve its side of the limit decides";
  EXPECT_FALSE(rowsAtLimit(1e-3, TreeSolve::Again, rows)) << "nor is one held that is really open";
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
