#pragma once
/// What stands on the window beside the scene.
#include <string>
#include <vector>

#include "apps/viewer/player.h"

namespace rubble::viewer {

/// What the panels and keys share.
struct Desk {
  bool showHelp = false;
  bool showPicker = false;
  bool focusPicker = false;
  std::string search;
  int choice = 0;           ///< of the picker
  bool takeChoice = false;  ///< Enter was pressed
  io::ColorBy colorBy = io::ColorBy::Body;
  std::optional<BodyId> selected;
  std::string message;  ///< the last error
};

/// The panels of one frame. Gives the scene that was chosen in the picker, or "".
std::string drawPanels(Desk& desk, Player& player, const std::vector<std::string>& scenes);

}  // namespace rubble::viewer
