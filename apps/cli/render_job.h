#pragma once
/// A film, or pictures, of one scene or of two side by side.
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <rubble/appearance.h>

#include "apps/cli/job.h"
#include "io/picture.h"
#include "render/camera_path.h"
#include "render/overlay.h"

namespace rubble::cli {

/// Lights in place of those of the scene; `lights` are added to them.
struct LightOptions {
  std::optional<Vec3> sunColor = {};
  std::optional<double> sunStrength = {}, skyStrength = {};
  std::vector<PointLight> lights = {};

  /// Throws Error if there are more lights than the renderer has room for.
  void apply(Appearance& to) const;
};

struct RenderOptions {
  JobOptions job;
  std::string out;  ///< "" only for a measurement
  int width = 1280, height = 720;
  double fieldOfView = .5;  ///< vertical [rad]
  std::string camera = "scene";
  std::optional<Vec3> eye, target;  ///< in place of the named camera's [m]
  double orbit = 0;                 ///< the camera turns about the target [rad/s of film]
  io::ColorBy colorBy = io::ColorBy::Body;
  double colorMax = 0;  ///< value of the hottest color; 0: the largest of each picture
  render::Overlays show;
  int samples = 0;                   ///< a pixel; 0: 32 for a single picture, 4 for a film (16 on a GPU)
  double fps = 30;                   ///< frames a second of film
  double slow = 1;                   ///< seconds of film for a second of the scene
  int every = 0;                     ///< a frame every so many steps; 0: by time
  int from = 0;                      ///< the film begins after this step
  std::vector<std::string> compare;  ///< two backends or two numbers of iterations
  std::shared_ptr<const render::CameraPath> path = nullptr;  ///< in place of the named camera's; or null
  std::optional<Vec3T<float>> background = {};               ///< linear, in place of the sky
  bool transparent = false;                                  ///< sky and planes are, in a .png
  std::string depthFile;    ///< view depths (layer_files.h), numbered as pictures are; "": none
  std::string normalsFile;  ///< normals, likewise
  std::optional<std::array<double, 2>> sun = {};  ///< as in PaintSettings [rad]
  LightOptions light = {};
  double shutter = 0;  ///< share of the time of a frame for which it is exposed: motion blur [1]
  bool overlay = false;
  bool quiet = false;
};

struct RenderResult {
  int frames = 0;
  std::string device;  ///< what drew
};

/// Throws Error for options that do not go together, and for what cannot be written.
RenderResult renderFilm(const RenderOptions& options);

struct RenderMeasure {
  std::string device;
  std::size_t bodies = 0;
  int frames = 0;
  double meanMs = 0, medianMs = 0, p95Ms = 0;  ///< a frame, from the poses to the picture on the device
  double cpuMs = 0;   ///< of all threads of the process, a frame; what a software renderer needs
  double stepMs = 0;  ///< of the simulation, a frame; 0: it stood still
  std::string boxes;  ///< "by compute", "as triangles"
  std::string poses;  ///< how they came to the renderer
  std::vector<std::pair<std::string, double>>
      passes;  ///< of frames drawn stage by stage: they add up to such a frame [ms]
};

/// Draws the scene as it begins, from `frames` places round about, with new poses each time; nothing is read
/// back or written. If it is `live`, a step is taken before each picture.
RenderMeasure measureRender(const RenderOptions& options, int frames, bool live);

}  // namespace rubble::cli
