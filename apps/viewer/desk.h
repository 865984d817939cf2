#pragma once
/// What keys, mouse and panels share.
#include <optional>
#include <string>
#include <vector>

#include "apps/viewer/player.h"
#include "render/overlay.h"

namespace rubble::viewer {

/// What the inspector shows.
struct Selection {
  std::optional<BodyId> body;
  std::optional<JointId> joint;
  std::optional<SoftId> object;
  int vertex = -1;  ///< of the object

  bool any() const { return body || joint || object; }
};

struct Desk {
  bool showHelp = false, showPicker = false, showPlots = false, showSettings = false;
  bool focusPicker = false;
  std::string search;
  int choice = 0;           ///< of the picker
  bool takeChoice = false;  ///< Enter was pressed
  io::ColorBy colorBy = io::ColorBy::Body;
  double fullValue = 0;  ///< of the hottest colour in the last picture
  render::Overlays overlays;
  Selection selection;
  std::string message;            ///< the last error
  std::optional<Request> wanted;  ///< to be opened next

  std::vector<IterationError> iterations;  ///< of the step after `iterationsOf`
  std::int64_t iterationsOf = -1;
  bool measureIterations = true;
};

/// The panels of one frame.
void drawPanels(Desk& desk, Show& show, const std::vector<std::string>& scenes);
void drawInspector(Desk& desk, Player& player);
void drawTimeline(Desk& desk, Show& show);
void drawPlots(Desk& desk, Player& player);
void drawSettings(Desk& desk, Player& player);

}  // namespace rubble::viewer
