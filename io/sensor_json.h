#pragma once
/// Sensors of scene files.
#include <functional>

#include <rubble/sensors.h>
#include <nlohmann/json.hpp>

#include "io/json_reader.h"

namespace rubble::io {

/// `body` and `joint` read the name or index of one; `body` also "world".
SensorDef readSensor(const Node& node, const std::function<int(const Node&)>& body,
                     const std::function<int(const Node&)>& joint);
nlohmann::ordered_json sensorJson(const SensorDef& sensor,
                                  const std::function<nlohmann::ordered_json(int)>& body,
                                  const std::function<nlohmann::ordered_json(int)>& joint);

}  // namespace rubble::io
