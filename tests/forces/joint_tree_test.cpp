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

/// Three rows that have all errors, and multipliers within the bound.
TEST(TreeRows, OfAGroupWithinItsBoundAreHeldAndThoseBeyondItAreNot) {
  const StepConstants c = testConstants();
  GroupSpec spec{};
  spec.mode = GroupMode::Hold;
  GroupRows<3> rows{};
  rows.state.rule.start = 10, rows.state.k = 10;
  rows.state.keepsMultiplier = 1;
  rows.lambda[0] = 3, rows.lambda[1] = -4;
  const Real error[3] = {.1, .2, -.1};
  for (const Real bound : {1e30, 1.}) {
    rows.state.bound = bound;
    TreePart<2> out{};
    Real own[3];
    addTreeGroup<3>(c, spec, rows, error, TreeSolve::Exact, out, own);
    ASSERT_EQ(out.count, 3);
    for (const TreeRow<2>& row : out.row)
      EXPECT_EQ(row.take, bound > 10 ? TreeTake::Held : TreeTake::Nothing) << bound;
  }
}

TEST(TreeRows, GiveMultipliersThatStayWithinTheBoundOfTheirGroup) {
  constexpr Real kForce[3] = {3, -4, 12};
  for (const Real bound : {1e30, 6.5}) {
    TreePart<2> part{};
    part.count = 3;
    for (int i = 0; i < 3; ++i) part.row[i] = {kForce[i], 0, {}, TreeTake::Held};
    PartRows<AnchorRows> rows{};
    rows.state.bound = bound;
    takeTreeForces<AnchorRows>(part, rows, Long6{}, Long6{}, 1);
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(rows.lambda[i], kForce[i] * std::min(Real(1), bound / 13), 1e-12) << bound;
  }
}

}  // namespace
}  // namespace rubble::RUBBLE_CORE
