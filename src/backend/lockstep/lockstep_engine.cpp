#include "backend/lockstep/lockstep_engine.h"

namespace rubble::RUBBLE_CORE {

namespace {

/// Engines of this precision are observable.
std::unique_ptr<ObservableEngine> observable(std::unique_ptr<Engine> engine) {
  return std::unique_ptr<ObservableEngine>(dynamic_cast<ObservableEngine*>(engine.release()));
}

}  // namespace

std::unique_ptr<Engine> makeLockstepEngine(std::unique_ptr<Engine> a, std::unique_ptr<Engine> b) {
  return std::make_unique<LockstepEngine>(observable(std::move(a)), observable(std::move(b)));
}

}  // namespace rubble::RUBBLE_CORE
