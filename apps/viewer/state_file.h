#pragma once
#include <string>

#include "apps/viewer/orbit.h"
#include "apps/viewer/ui_state.h"

namespace rubble::viewer {

/// What the window shows, as JSON.
std::string stateText(int frame, Session& session, const std::string& scene, const UiState& uiState,
                      const Orbit& orbit, bool holds);

}  // namespace rubble::viewer
