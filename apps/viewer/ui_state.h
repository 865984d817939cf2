#pragma once
/// State shared by keys, mouse and panels.
#include <optional>
#include <string>
#include <vector>

#include "apps/viewer/player.h"
#include "apps/viewer/thumbnails.h"
#include "render/overlay.h"

namespace rubble::viewer {

/// The selected object, which the inspector shows.
struct Selection {
  std::optional<BodyId> body;
  std::optional<JointId> joint;
  std::optional<DeformableId> object;
  int vertex = -1;  ///< of the object

  bool any() const { return body || joint || object; }
};

struct UiState {
  bool showHelp = false, showPicker = false, showPlots = false, showSettings = false;
  bool focusPicker = false;
  std::string search;
  int choice = 0;           ///< of the picker
  bool takeChoice = false;  ///< Enter was pressed
  Thumbnails thumbnails;    ///< of the picker
  io::ColorBy colorBy = io::ColorBy::Body;
  double fullValue = 0;  ///< of the hottest color in the last picture
  render::Overlays overlays;
  Selection selection;
  std::string message;            ///< the last error
  std::optional<Request> wanted;  ///< to be opened next

  std::vector<IterationError> iterations;  ///< of the step after `iterationsOf`
  std::int64_t iterationsOf = -1;
  bool measureIterations = true;
};

/// The panels of one frame.
void drawPanels(UiState& uiState, Session& session, const std::vector<std::string>& scenes);
void drawInspector(UiState& uiState, Player& player);
void drawTimeline(UiState& uiState, Session& session);
void drawPlots(UiState& uiState, Player& player);
void drawSettings(UiState& uiState, Player& player);

}  // namespace rubble::viewer
