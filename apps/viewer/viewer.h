#pragma once
/// The interactive window.
#include <string>
#include <vector>

#include "apps/viewer/player.h"

namespace rubble::viewer {

struct ViewerOptions {
  Request first;                    ///< a scene, a scene file or a recording
  std::vector<std::string> scenes;  ///< what the picker offers
  SceneOpener open;
  int sides = 1;  ///< 2: two runs of the scene side by side
  int width = 1280, height = 720;
  int frames = 0;          ///< closes after so many frames; 0: when the user closes it
  std::string screenshot;  ///< the last frame, with its panels, goes into this PNG file
  std::string stateFile;   ///< what the window shows, as JSON, written anew in every frame: for tests that
                           ///< drive the window
};

/// Opens a window and runs until it is closed. Throws Error without a display or OpenGL 4.1.
void runViewer(const ViewerOptions& options);

}  // namespace rubble::viewer
