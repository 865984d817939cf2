#include "io/soft_mesh.h"

#include <filesystem>

#include "io/mesh_file.h"
#include "io/shape_json.h"

namespace rubble::io {

namespace {

/// What a file says of how its mesh is used.
struct MeshUse {
  std::string file;    ///< as written
  double scale = 1;    ///< metres in a unit of the file
  Vec3 position;       ///< [m]
  Quat orientation;    ///< mesh -> world
  double cell = 0;     ///< width of the cells that a surface is filled with; 0: not given [m]
  double segment = 0;  ///< length of the segments of a cable; 0: not given [m]

  Vec3 place(const Vec3& x) const { return position + rotate(orientation, scale * x); }
};

void fill(const Node& node, const MeshUse& use, MeshFile mesh, TetSolidDef& out) {
  if (!mesh.tetrahedra.empty()) {
    if (use.cell > 0) return node.child("cell").faultText("expected no cell: the file has tetrahedra");
    TetSolidDef made = tetSolidFromMesh(tetrahedraOf(mesh));
    out.vertices = std::move(made.vertices), out.tetrahedra = std::move(made.tetrahedra);
    return;
  }
  if (mesh.triangles.empty())
    return node.child("file").faultText("expected tetrahedra or a closed surface, got neither in " +
                                        use.file);
  if (!(use.cell > 0))
    return node.faultText(
        "expected \"cell\", the width of the cells that the surface is filled with [m]: the file has no "
        "tetrahedra");
  TetrahedronMesh made = tetrahedralize(mesh.surface(), use.cell, use.file);
  out.vertices = std::move(made.vertices), out.tetrahedra = std::move(made.tetrahedra);
}
void fill(const Node& node, const MeshUse& use, MeshFile mesh, ClothDef& out) {
  if (mesh.triangles.empty())
    return node.child("file").faultText("expected triangles, got none in " + use.file);
  ClothDef made = clothFromMesh(mesh.surface());
  out.vertices = std::move(made.vertices), out.triangles = std::move(made.triangles);
}
void fill(const Node& node, const MeshUse& use, MeshFile mesh, CableDef& out) {
  if (mesh.lines.empty()) return node.child("file").faultText("expected a line, got none in " + use.file);
  std::vector<Vec3> points = lineOf(mesh, use.file);
  const bool closed = points.size() > 3 && points.front() == points.back();
  if (closed) points.pop_back();
  out.closed = closed;
  out.vertices = use.segment > 0 ? cableAlong(points, use.segment, closed).vertices : points;
}
template <class D> void fill(const Node& node, const MeshUse&, const MeshFile&, D&) {
  node.faultText("expected no mesh: solids, sheets and rods have one");
}

}  // namespace

void readMeshInto(const Node& node, const std::string& folder, Deformable& out) {
  MeshUse use;
  ObjectReader object(node, "a mesh");
  if (!object.isObject()) return;
  const auto file = object.need("file", "the name of an .obj, .stl, .ply or .msh file");
  if (file) use.file = file->text().value_or("");
  object.read("scale", use.scale, {0, false, std::numeric_limits<double>::infinity(), "a number above 0"});
  object.read("position", use.position);
  if (const auto found = object.get("orientation")) use.orientation = readOrientation(*found);
  if (std::holds_alternative<TetSolidDef>(out))
    object.read("cell", use.cell, {0, false, std::numeric_limits<double>::infinity(), "a width above 0 [m]"});
  if (std::holds_alternative<CableDef>(out))
    object.read("segment", use.segment,
                {0, false, std::numeric_limits<double>::infinity(), "a length above 0 [m]"});
  object.finish();
  if (use.file.empty()) return;
  DeformableDef& def = common(out);
  if (!def.vertices.empty()) return node.faultText("expected a mesh or \"vertices\", got both");
  try {
    const std::filesystem::path path(use.file);
    MeshFile mesh = readMesh((path.is_absolute() ? path : std::filesystem::path(folder) / path).string());
    for (Vec3& x : mesh.vertices) x = use.place(x);
    std::visit([&](auto& own) { fill(node, use, std::move(mesh), own); }, out);
  } catch (const Error& error) {
    node.child("file").faultText(error.what());
  }
}

}  // namespace rubble::io
