#pragma once
#include <map>
#include <string>

#include "io/json_reader.h"

namespace rubble::io {

/// Reads bodies and the materials that they name.
class BodyReader {
 public:
  /// The table that material() looks names up in.
  void readMaterials(const Node& node);
  BodyDef body(const Node& node) const;

 private:
  Material material(const Node& node) const;

  std::map<std::string, Material> materials_;
};

/// A unit quaternion [w, x, y, z], or an axis with an angle in degrees.
Quat readOrientation(const Node& node);

}  // namespace rubble::io
