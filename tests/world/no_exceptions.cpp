#include "no_exceptions.h"

#include <rubble/rubble.h>

#if defined(__cpp_exceptions)
#error "this file is compiled without exceptions"
#endif

namespace rubble::test {

std::string withoutExceptions() {
  Scene scene;
  scene.bodies.resize(3);
  scene.bodies[0].mass = -1;
  const Result<World> refused = attempt([&] { return World(scene); });
  if (refused) return "a world of a negative mass";
  scene.bodies[0].mass = 1;
  Result<World> world = attempt([&] { return World(scene); });
  if (!world) return world.failure().message;
  const Result<StepReport> report = attempt([&] { return world->step(); });
  const Result<bool> removed = attempt([&] { world->removeBody({9, 0}); });
  return refused.failure().message + "; " + std::to_string(report ? report->bodies : -1) + " bodies; " +
         removed.failure().message;
}

}  // namespace rubble::test
