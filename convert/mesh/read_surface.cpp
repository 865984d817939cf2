#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>

#include <rubble/error.h>

#include "convert/mesh/mesh_import.h"

#if defined(RUBBLE_HAS_ASSIMP)
#include <assimp/DefaultIOSystem.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/Importer.hpp>
#endif

namespace rubble::convert {
namespace {

std::string endingOf(const std::string& file) {
  std::string ending = std::filesystem::path(file).extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return ending;
}

const std::vector<std::string> kOwn{".obj", ".stl", ".ply", ".msh"};
const std::vector<std::string> kOthers{".dae", ".gltf", ".glb", ".fbx", ".3ds", ".off", ".x3d", ".3mf"};

bool contains(const std::vector<std::string>& endings, const std::string& ending) {
  return std::count(endings.begin(), endings.end(), ending) > 0;
}

#if defined(RUBBLE_HAS_ASSIMP)
/// Opens files of one folder and those below it.
class FolderIo final : public Assimp::DefaultIOSystem {
 public:
  explicit FolderIo(const std::string& file)
      : folder_(std::filesystem::weakly_canonical(std::filesystem::absolute(file).parent_path())) {}
  Assimp::IOStream* Open(const char* file, const char* mode) override {
    const std::filesystem::path path = std::filesystem::weakly_canonical(std::filesystem::absolute(file));
    const auto [inFolder, end] = std::mismatch(folder_.begin(), folder_.end(), path.begin(), path.end());
    if (inFolder != folder_.end()) throw Error(file, "a file in the folder of the mesh", "one outside of it");
    return DefaultIOSystem::Open(file, mode);
  }

 private:
  std::filesystem::path folder_;
};

TriangleMesh readByAssimp(const std::string& file, bool asWritten) {
  Assimp::Importer importer;
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_IGNORE_UP_DIRECTION, asWritten);
  importer.SetIOHandler(new FolderIo(file));  // the importer deletes it
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const aiScene* const scene = importer.ReadFile(
      file, aiProcess_Triangulate | aiProcess_PreTransformVertices | aiProcess_SortByPType);
  if (!scene) throw Error(file, "a mesh that assimp reads", importer.GetErrorString());
  TriangleMesh out;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    const aiMesh& mesh = *scene->mMeshes[m];
    const int first = static_cast<int>(out.vertices.size());
    for (unsigned v = 0; v < mesh.mNumVertices; ++v) {
      const aiVector3D& x = mesh.mVertices[v];
      const Vec3 point{static_cast<double>(x.x), static_cast<double>(x.y), static_cast<double>(x.z)};
      if (!(lengthSquared(point) < 1e30)) throw Error(file, "coordinates below 1e15", "others");
      out.vertices.push_back(point);
    }
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices != 3) continue;
      out.triangles.push_back({first + static_cast<int>(face.mIndices[0]),
                               first + static_cast<int>(face.mIndices[1]),
                               first + static_cast<int>(face.mIndices[2])});
    }
  }
  return out;
}
#else
TriangleMesh readByAssimp(const std::string& file, bool) {
  throw Error(file,
              "a build with assimp (Debian: apt-get install libassimp-dev), or an OBJ, STL, PLY or MSH file",
              "\"" + endingOf(file) + "\"");
}
#endif

/// Joins vertices at one place, and leaves triangles without an area out.
TriangleMesh welded(const TriangleMesh& mesh) {
  TriangleMesh out;
  std::map<std::array<double, 3>, int> numbers;
  std::vector<int> numberOf;
  for (const Vec3& x : mesh.vertices) {
    const auto [at, isNew] = numbers.try_emplace({x.x + 0.0, x.y + 0.0, x.z + 0.0},
                                                 static_cast<int>(numbers.size()));
    if (isNew) out.vertices.push_back(x);
    numberOf.push_back(at->second);
  }
  for (const auto& t : mesh.triangles) {
    const auto at = [&](std::size_t k) { return numberOf[static_cast<std::size_t>(t[k])]; };
    if (at(0) != at(1) && at(1) != at(2) && at(2) != at(0)) out.triangles.push_back({at(0), at(1), at(2)});
  }
  return out;
}

TriangleMesh surfaceOf(const std::string& file, bool asWritten) {
  const bool isOwn = contains(kOwn, endingOf(file));
  TriangleMesh mesh = welded(isOwn ? io::readMesh(file).surface() : readByAssimp(file, asWritten));
  if (mesh.triangles.empty()) throw Error(file, "triangles", "none");
  return mesh;
}

}  // namespace

TriangleMesh readSurfaceAsWritten(const std::string& file) { return surfaceOf(file, true); }

bool isMeshFile(const std::string& file) {
  return contains(kOwn, endingOf(file)) || contains(kOthers, endingOf(file));
}

TriangleMesh readSurface(const std::string& file, double scale, const std::string& up) {
  if (!(scale > 0)) throw Error("--scale", "a factor above 0", std::to_string(scale));
  if (!up.empty() && up != "y" && up != "z") throw Error("--up", "y or z", up);
  TriangleMesh mesh = surfaceOf(file, false);
  // assimp turns what it reads to y up
  const bool isYUp = up.empty() ? !contains(kOwn, endingOf(file)) : up == "y";
  for (Vec3& x : mesh.vertices) {
    if (isYUp) x = {x.x, -x.z, x.y};
    x *= scale;
  }
  return mesh;
}

}  // namespace rubble::convert
