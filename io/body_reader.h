#pragma once
#include <map>
#include <string>
#include <vector>

#include "io/json_reader.h"

namespace rubble::io {

/// Words for the values of Motion.
const std::vector<std::string>& motionNames();

/// Reads bodies and the materials that they name.
class BodyReader {
 public:
  /// The table that material() looks names up in.
  void readMaterials(const Node& node);
  /// The table that bodies look up shapes in. After the materials, which parts may name.
  void readShapes(const Node& node);
  BodyDef body(const Node& node) const;
  /// A material, or the name of one of the table.
  Material material(const Node& node) const;
  /// A shape, or the name of one of the table.
  Shape shape(const Node& node) const;

 private:
  std::map<std::string, Material> materials_;
  std::map<std::string, Shape> shapes_;
};

}  // namespace rubble::io
