/// Breaking joints: which joints break must not depend on the number of iterations.
#include <gtest/gtest.h>
#include <scenes/registry.h>

#include "tests/support/scenes.h"

namespace rubble {
namespace {

/// Joints of the breakable wall that are broken a second after the balls have struck.
double brokenAt(int iterations) {
  const scenes::Spec& spec = scenes::find("breakable-wall");
  scenes::Job job = scenes::prepare(spec, scenes::resolve(spec, {}));
  return scenes::Runner(std::move(job), test::options(iterations)).run(60).metrics.at("broken");
}

/// Few iterations against converged ones. Between 12 and 60 fewer break, which docs/scenes.md counts among
/// what is open.
TEST(Breakage, OfAWallIsLocalAtFewAndManyIterations) {
  const double few = brokenAt(4), many = brokenAt(100);
  EXPECT_GE(many, 10);
  EXPECT_LE(few, 2.5 * many);
  EXPECT_LE(many, 2 * few);
}

}  // namespace
}  // namespace rubble
