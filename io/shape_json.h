#pragma once
/// Shapes and materials of scene files.
#include <array>
#include <functional>
#include <map>
#include <string>

#include "io/json_reader.h"

namespace rubble::io {

/// A shape, or the name of one among `named`. `material` reads that of a part of a compound.
Shape readShape(const Node& node, const std::map<std::string, Shape>& named,
                const std::function<Material(const Node&)>& material);
Material readMaterial(const Node& node);

nlohmann::ordered_json shapeJson(const Shape& shape);
nlohmann::ordered_json materialJson(const Material& material);
/// All numbers of a material: equal ones are one.
std::vector<double> materialKey(const Material& material);
/// A unit quaternion [w, x, y, z], or an axis with an angle in degrees.
Quat readOrientation(const Node& node);

}  // namespace rubble::io
