#pragma once
/// Models from other programs as scenes: MJCF (MuJoCo), URDF with SRDF, USD with UsdPhysics, and glTF with
/// KHR_physics_rigid_bodies. docs/importing.md lists what is supported.
#include <map>
#include <string>
#include <vector>

#include "convert/report.h"
#include "io/scene_json.h"

namespace rubble::convert {

struct ImportOptions {
  /// URDF: folder of each ROS package. Packages that are not named are searched upward from the model.
  std::map<std::string, std::string> packages;
  /// Folders, besides that of the model and those of its packages, from which files may be read.
  std::vector<std::string> folders;
  std::string key;            ///< MJCF: name or index of the keyframe that the scene starts in; "": none
  std::string srdf;           ///< URDF: an SRDF file with pairs of links that do not collide; "": none
  bool floatingBase = false;  ///< URDF: the root link is free; otherwise it is static
};

struct Import {
  io::SceneFile file;
  Report report;
};

/// Does importModel read this file? By its ending; glTF files that hold no physics are meshes.
bool isModelFile(const std::string& file);

/// Reads a model file. Throws Error with file, line and path ("robot.xml:12: geom.size") of what is invalid:
/// malformed XML, includes that form a cycle, files outside of the folders, numbers that are not finite.
/// Everything else that has no counterpart is in the report.
Import importModel(const std::string& file, const ImportOptions& options = {});
/// The same for a content in memory, whose format its first bytes tell. `name`: in places and errors. No
/// other file is read.
Import importContent(const std::string& content, const std::string& name, const ImportOptions& options = {});

}  // namespace rubble::convert
