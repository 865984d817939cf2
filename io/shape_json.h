#pragma once
/// Shapes and materials of scene files.
#include <array>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "io/json_reader.h"

namespace rubble::io {

/// A shape, or the name of one among `named`. `material` reads that of a part of a compound.
Shape readShape(const Node& node, const std::map<std::string, Shape>& named,
                const std::function<Material(const Node&)>& material);
Material readMaterial(const Node& node);
/// Words for the values of Combine.
const std::vector<std::string>& combineNames();
MaterialPair readMaterialPair(const Node& node);

nlohmann::ordered_json shapeJson(const Shape& shape);
nlohmann::ordered_json materialJson(const Material& material);
nlohmann::ordered_json materialPairJson(const MaterialPair& pair);
/// A unit quaternion [w, x, y, z], or an axis with an angle in degrees.
Quat readOrientation(const Node& node);

}  // namespace rubble::io
