#pragma once
/// URDF, the model format of ROS (https://wiki.ros.org/urdf/XML), and SRDF.
#include "convert/import.h"
#include "convert/model.h"
#include "convert/source.h"

namespace rubble::convert {

Model readUrdf(Source& source, pugi::xml_node root, const ImportOptions& options, Report& report);
/// Adds the pairs of links that an SRDF file excludes from collision.
void readSrdf(Source& source, const std::string& file, Model& model, Report& report);

}  // namespace rubble::convert
