#pragma once
/// glTF 2.0 with KHR_physics_rigid_bodies and KHR_implicit_shapes (github.com/eoineoineoin/glTF_Physics).
#include "convert/folders.h"
#include "convert/model.h"

namespace rubble::convert {

Model readGltf(const std::string& bytes, const std::string& file, Folders& folders, Report& report);
/// Is this a glTF file with physics? A file that cannot be read is none.
bool isGltfFile(const std::string& file);

}  // namespace rubble::convert
