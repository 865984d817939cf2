#pragma once
#include <string>

#include "apps/viewer/desk.h"
#include "apps/viewer/orbit.h"

namespace rubble::viewer {

/// What the window shows, as JSON.
std::string stateText(int frame, Show& show, const std::string& scene, const Desk& desk, const Orbit& orbit,
                      bool holds);

}  // namespace rubble::viewer
