#pragma once
/// MJCF, the model format of MuJoCo (https://mujoco.readthedocs.io/en/stable/XMLreference.html).
#include "convert/import.h"
#include "convert/model.h"
#include "convert/source.h"

namespace rubble::convert {

Model readMjcf(Source& source, pugi::xml_node root, const ImportOptions& options, Report& report);

}  // namespace rubble::convert
