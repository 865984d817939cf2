#pragma once
/// A camera that moves by key frames of a file.
#include <string>
#include <vector>

#include "render/camera.h"

namespace rubble::render {

/// Where the camera is at a time of the film.
struct CameraKey {
  double time = 0;         ///< of film [s]
  Vec3 eye, target;        ///< [m]
  double fieldOfView = 0;  ///< full vertical angle [rad]; 0: as otherwise
};

class CameraPath {
 public:
  /// Reads a JSON list of objects with "time" [s], "eye" and "target" [m] and, optionally, "fov" [degrees].
  /// Throws Error with the path of the first fault.
  explicit CameraPath(const std::string& file);
  /// Times must ascend. Throws Error otherwise.
  CameraPath(std::vector<CameraKey> keys, const std::string& name);

  /// On a smooth curve through the keys (Catmull and Rom 1974); before the first and after the last one it
  /// stands. `usual`: up, and the field of view of keys without one.
  Camera at(double time, const Camera& usual) const;

 private:
  std::vector<CameraKey> keys_;
};

}  // namespace rubble::render
