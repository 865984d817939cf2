#pragma once
/// Actuators of scene files.
#include <functional>

#include <rubble/actuators.h>
#include <nlohmann/json.hpp>

#include "io/json_reader.h"

namespace rubble::io {

/// `body` and `joint` read the name or index of one.
ActuatorDef readActuator(const Node& node, const std::function<int(const Node&)>& body,
                         const std::function<int(const Node&)>& joint);
nlohmann::ordered_json actuatorJson(const ActuatorDef& actuator,
                                    const std::function<nlohmann::ordered_json(int)>& body);

}  // namespace rubble::io
