#pragma once
/// Looks, lights and cameras of scene files and recordings.
#include <functional>
#include <string>

#include <rubble/appearance.h>
#include <nlohmann/json.hpp>

#include "io/json_reader.h"

namespace rubble::io {

/// `body` reads the name or index of one, or "world"; `shape` a shape or the name of one. A part without a
/// shape has that of its body in `bodies`.
Look readLook(const Node& node, const std::function<int(const Node&)>& body,
              const std::function<Shape(const Node&)>& shape, const std::vector<BodyDef>& bodies);
/// `shape`: the JSON of a shape, or its name.
nlohmann::ordered_json lookJson(const Look& look, const nlohmann::ordered_json& body,
                                const std::function<nlohmann::ordered_json(const Shape&)>& shape);
NamedCamera readNamedCamera(const Node& node);
nlohmann::ordered_json namedCameraJson(const NamedCamera& camera);
/// The sun: a direction, or an object with its direction, color and strength.
void readSun(const Node& node, Daylight& out);
/// An empty object if all is as usual.
nlohmann::ordered_json sunJson(const Daylight& light);
PointLight readPointLight(const Node& node);
nlohmann::ordered_json pointLightJson(const PointLight& light);

/// All of it as one text, with bodies by their indices.
std::string appearanceText(const Appearance& appearance);
/// Nothing if it is not what appearanceText() wrote.
std::optional<Appearance> appearanceOf(const std::string& text);

}  // namespace rubble::io
