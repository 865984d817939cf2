/// OBJ and STL, and the choice of a format.
#include "io/mesh_file.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <unordered_map>

#include "io/mesh_readers.h"
#include "io/output_file.h"

namespace rubble::io {

namespace {

/// Number of the vertex with exactly that place.
class Welder {
 public:
  explicit Welder(std::vector<Vec3>& vertices) : vertices_(vertices) {}
  int operator()(const Vec3& x) {
    // 0 and -0 are one place
    const auto [entry, isNew] = numbers_.emplace(std::array<double, 3>{x.x + 0., x.y + 0., x.z + 0.},
                                                 static_cast<int>(vertices_.size()));
    if (isNew) vertices_.push_back(x);
    return entry->second;
  }

 private:
  std::vector<Vec3>& vertices_;
  std::map<std::array<double, 3>, int> numbers_;
};

/// "12", "12/5", "12//7" or "-1/2/3": the vertex, from 0.
int objCorner(const MeshBytes& in, std::string_view word, std::size_t vertices) {
  const long long number = in.toWhole(word.substr(0, word.find('/')), "the number of a vertex");
  const long long index = number < 0 ? static_cast<long long>(vertices) + number : number - 1;
  if (index < 0 || index >= static_cast<long long>(vertices))
    in.fail("the number of one of " + std::to_string(vertices) + " vertices", std::to_string(number));
  return static_cast<int>(index);
}

MeshFile readObj(MeshBytes& in) {
  MeshFile out;
  while (const auto line = in.nextLine()) {
    Words words(*line);
    const std::string_view key = *words.next();
    if (key == "v") {
      Vec3 x;
      for (int axis = 0; axis < 3; ++axis)
        x[axis] = in.toNumber(words.next().value_or(""), "three coordinates");
      out.vertices.push_back(x);
    } else if (key == "f" || key == "l") {
      std::vector<int> corners;
      while (const auto word = words.next()) corners.push_back(objCorner(in, *word, out.vertices.size()));
      const std::size_t least = key == "f" ? 3 : 2;
      if (corners.size() < least)
        in.fail("at least " + std::to_string(least) + " vertices", std::to_string(corners.size()));
      if (key == "f")
        addPolygon(corners, out);
      else
        out.lines.push_back(std::move(corners));
    }
  }
  return out;
}

MeshFile readTextStl(MeshBytes& in) {
  MeshFile out;
  Welder weld(out.vertices);
  in.line();
  std::vector<int> corners;
  while (const auto line = in.nextLine()) {
    Words words(*line);
    const std::string_view key = *words.next();
    if (key == "vertex") {
      Vec3 x;
      for (int axis = 0; axis < 3; ++axis)
        x[axis] = in.toNumber(words.next().value_or(""), "three coordinates");
      corners.push_back(weld(x));
    } else if (key == "endfacet") {
      if (corners.size() != 3) in.fail("a facet of three vertices", std::to_string(corners.size()));
      addPolygon(corners, out);
      corners.clear();
    } else if (key == "endsolid") {
      return out;
    } else if (key != "facet" && key != "outer" && key != "endloop") {
      in.fail("\"facet\", \"vertex\" or \"endsolid\"", "\"" + std::string(key) + "\"");
    }
  }
  in.fail("\"endsolid\"", "the end of the file");
}

constexpr std::size_t kStlHeader = 80, kStlTriangle = 50;

MeshFile readBinaryStl(MeshBytes& in) {
  constexpr bool kSwap = std::endian::native == std::endian::big;
  in.seek(kStlHeader);
  const auto count = in.binary<std::uint32_t>(kSwap, "the number of triangles");
  if (in.left() != count * kStlTriangle)
    in.failByte(std::to_string(count) + " triangles of 50 bytes", std::to_string(in.left()) + " bytes");
  MeshFile out;
  Welder weld(out.vertices);
  for (std::uint32_t i = 0; i < count; ++i) {
    for (int k = 0; k < 3; ++k) in.binary<float>(kSwap, "a normal");
    std::vector<int> corners;
    for (int k = 0; k < 3; ++k) {
      Vec3 x;
      for (int axis = 0; axis < 3; ++axis)
        x[axis] = static_cast<double>(in.binary<float>(kSwap, "a coordinate"));
      if (!(x.x - x.x + x.y - x.y + x.z - x.z == 0)) in.failByte("three finite coordinates", "others");
      corners.push_back(weld(x));
    }
    in.binary<std::uint16_t>(kSwap, "an attribute");
    addPolygon(corners, out);
  }
  return out;
}

/// A text begins with "solid", but so do some binary files: those have the size that their count says.
MeshFile readStl(MeshBytes& in) {
  if (in.left() >= kStlHeader + 4) {
    MeshBytes copy = in;
    copy.seek(kStlHeader);
    const auto count = copy.binary<std::uint32_t>(std::endian::native == std::endian::big,
                                                  "the number of triangles");
    if (copy.left() == count * kStlTriangle) return readBinaryStl(in);
  }
  if (!in.all().starts_with("solid"))
    in.failByte("\"solid\", or the size of a binary STL file",
                std::to_string(in.left()) + " bytes of something else");
  return readTextStl(in);
}

}  // namespace

void addPolygon(const std::vector<int>& corners, MeshFile& out) {
  for (std::size_t k = 2; k < corners.size(); ++k)
    out.triangles.push_back({corners[0], corners[k - 1], corners[k]});
}

namespace {

enum class Format { Obj, Stl, Ply, Msh };

Format formatOf(const std::string& file) {
  std::string ending = std::filesystem::path(file).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending == ".obj") return Format::Obj;
  if (ending == ".stl") return Format::Stl;
  if (ending == ".ply") return Format::Ply;
  if (ending == ".msh") return Format::Msh;
  throw Error(file, "a name that ends in .obj, .stl, .ply or .msh", "\"" + ending + "\"");
}

MeshFile read(MeshBytes& in, Format format) {
  switch (format) {
    case Format::Obj:
      return readObj(in);
    case Format::Stl:
      return readStl(in);
    case Format::Ply:
      return readPly(in);
    case Format::Msh:
      return readMsh(in);
  }
  return {};
}

MeshFile notEmpty(MeshFile mesh, const std::string& file) {
  if (mesh.triangles.empty() && mesh.tetrahedra.empty() && mesh.lines.empty())
    throw Error(file, "triangles, tetrahedra or lines", "none");
  return mesh;
}

}  // namespace

MeshFile readMesh(const std::string& file) {
  const Format format = formatOf(file);
  MeshBytes in(file);
  return notEmpty(read(in, format), file);
}

MeshFile parseMesh(const std::string& name, std::string content) {
  const Format format = formatOf(name);
  MeshBytes in(name, std::move(content));
  return notEmpty(read(in, format), name);
}

TetrahedronMesh tetrahedraOf(const MeshFile& mesh) {
  TetrahedronMesh out;
  std::vector<int> number(mesh.vertices.size(), -1);
  for (auto t : mesh.tetrahedra) {
    for (int& v : t) {
      int& own = number[static_cast<std::size_t>(v)];
      if (own < 0) {
        own = static_cast<int>(out.vertices.size());
        out.vertices.push_back(mesh.vertices[static_cast<std::size_t>(v)]);
      }
      v = own;
    }
    out.tetrahedra.push_back(t);
  }
  return out;
}

std::vector<Vec3> lineOf(const MeshFile& mesh, const std::string& path) {
  std::unordered_map<int, std::vector<int>> beside;
  for (const auto& line : mesh.lines)
    for (std::size_t k = 1; k < line.size(); ++k) {
      if (line[k] == line[k - 1]) continue;
      beside[line[k]].push_back(line[k - 1]), beside[line[k - 1]].push_back(line[k]);
    }
  if (beside.empty()) throw Error(path, "a line", "none");
  int start = -1, ends = 0;
  for (const auto& line : mesh.lines)
    for (const int v : line) {
      const auto found = beside.find(v);
      const std::size_t degree = found == beside.end() ? 0 : found->second.size();
      if (degree > 2)
        throw Error(path, "one line that does not branch",
                    std::to_string(degree) + " lines at vertex " + std::to_string(v));
      if (degree == 1 && start < 0) start = v;
    }
  for (const auto& [v, others] : beside) ends += others.size() == 1;
  if (ends > 2) throw Error(path, "one line", std::to_string(ends / 2) + " of them");
  const bool closed = start < 0;
  // the first vertex that has a neighbor: a line may also stand still at one
  for (const auto& line : mesh.lines)
    for (const int v : line)
      if (start < 0 && beside.contains(v)) start = v;
  std::vector<int> order{start};
  for (int before = -1, at = start;;) {
    const std::vector<int>& others = beside[at];
    const int next = others[0] != before || others.size() == 1 ? others[0] : others[1];
    if (next == before && others.size() == 1) break;
    before = at, at = next;
    order.push_back(at);
    if (at == start) break;
  }
  if (order.size() != beside.size() + (closed ? 1 : 0))
    throw Error(path, "one line", "several that do not meet");
  std::vector<Vec3> out;
  for (const int v : order) out.push_back(mesh.vertices[static_cast<std::size_t>(v)]);
  return out;
}

void writeObj(const std::string& file, const TriangleMesh& mesh) {
  OutputFile target(file);
  std::ostream& out = target.stream();
  out.precision(17);
  for (const Vec3& x : mesh.vertices) out << "v " << x.x << ' ' << x.y << ' ' << x.z << '\n';
  for (const auto& t : mesh.triangles) out << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
  target.finish();
}

void writeMsh(const std::string& file, const TetrahedronMesh& mesh) {
  OutputFile target(file);
  std::ostream& out = target.stream();
  out.precision(17);
  const std::size_t nodes = mesh.vertices.size(), cells = mesh.tetrahedra.size();
  out << "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 " << nodes << " 1 " << nodes << "\n3 1 0 " << nodes
      << '\n';
  for (std::size_t i = 1; i <= nodes; ++i) out << i << '\n';
  for (const Vec3& x : mesh.vertices) out << x.x << ' ' << x.y << ' ' << x.z << '\n';
  out << "$EndNodes\n$Elements\n1 " << cells << " 1 " << cells << "\n3 1 4 " << cells << '\n';
  for (std::size_t i = 0; i < cells; ++i) {
    out << i + 1;
    for (const int v : mesh.tetrahedra[i]) out << ' ' << v + 1;
    out << '\n';
  }
  out << "$EndElements\n";
  target.finish();
}

}  // namespace rubble::io
