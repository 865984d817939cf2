#pragma once
/// The key "mesh" of deformable objects in scene files: their vertices and elements are read, or made, from a
/// mesh file.
#include <string>

#include "io/json_reader.h"

namespace rubble::io {

/// Fills vertices and elements of an object. `folder`: where files without a full path lie. Whatever is wrong
/// is noted as a fault.
void readMeshInto(const Node& node, const std::string& folder, Deformable& out);

}  // namespace rubble::io
