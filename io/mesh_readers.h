#pragma once
/// One reader a format.
#include "io/mesh_bytes.h"
#include "io/mesh_file.h"

namespace rubble::io {

MeshFile readPly(MeshBytes& in);
MeshFile readMsh(MeshBytes& in);

/// Cuts a polygon into triangles about its first corner.
void addPolygon(const std::vector<int>& corners, MeshFile& out);

}  // namespace rubble::io
