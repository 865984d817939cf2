/// <asset>: meshes, height fields and models.
#include <algorithm>
#include <bit>
#include <cstring>
#include <fstream>

#include "convert/mjcf_reader.h"
#include "io/mesh_file.h"
#include "io/picture.h"

namespace rubble::convert {
namespace {

constexpr std::size_t kMostNumbers = std::size_t{1} << 24;
constexpr int kMostSamples = 1 << 14;

/// Heights of MuJoCo's binary format: the counts of rows and columns, then the samples in single precision.
std::vector<double> readSamples(const std::filesystem::path& file, MjcfHeightField& field,
                                const std::string& who) {
  std::ifstream in(file, std::ios::binary);
  std::int32_t counts[2] = {};
  static_assert(std::endian::native == std::endian::little);
  in.read(reinterpret_cast<char*>(counts), sizeof counts);
  if (!in || counts[0] < 2 || counts[1] < 2 || counts[0] > kMostSamples || counts[1] > kMostSamples)
    throw Error(who, "a binary height field (2 to 16384 rows and columns)", file.filename().string());
  field.rows = counts[0], field.columns = counts[1];
  std::vector<float> samples(static_cast<std::size_t>(field.rows) * static_cast<std::size_t>(field.columns));
  in.read(reinterpret_cast<char*>(samples.data()),
          static_cast<std::streamsize>(samples.size() * sizeof(float)));
  if (!in) throw Error(who, std::to_string(samples.size()) + " samples", "fewer");
  return {samples.begin(), samples.end()};
}

/// Heights of a picture, by its red channel as in MuJoCo. Its first row is that of the largest y.
std::vector<double> pictureSamples(const std::filesystem::path& file, MjcfHeightField& field,
                                   const std::string& who) {
  const io::Image picture = io::readPng(file.string());
  field.rows = picture.height, field.columns = picture.width;
  if (std::min(field.rows, field.columns) < 2 || std::max(field.rows, field.columns) > kMostSamples)
    throw Error(who, "a picture of 2 to 16384 rows and columns", file.filename().string());
  std::vector<double> out;
  const auto columns = static_cast<std::size_t>(field.columns);
  for (std::size_t row = static_cast<std::size_t>(field.rows); row-- > 0;)
    for (std::size_t i = 0; i < columns; ++i) out.push_back(picture.rgb[3 * (row * columns + i)]);
  return out;
}

/// Samples become 0 to 1.
void normalizeSamples(std::vector<double>& samples) {
  const auto [low, high] = std::minmax_element(samples.begin(), samples.end());
  const double least = *low, range = *high - *low;
  for (double& sample : samples) sample = range > 0 ? (sample - least) / range : 0;
}

}  // namespace

void MjcfReader::readAssets(pugi::xml_node node) {
  for (const pugi::xml_node& child : source_.children(node)) {
    const std::string_view type = child.name();
    if (type == "mesh") readMesh(tagOf(child));
    if (type == "hfield") readHeightField(tagOf(child));
    if (type == "texture") readTexture(tagOf(child));
    if (type == "material") readMaterial(tagOf(child));
    if (type == "model") readModel(Tag(source_, child));
  }
}

std::filesystem::path MjcfReader::assetFile(const Tag& tag, const std::string& folder) {
  std::string name = tag.need("file");
  if (compiler_.stripPath) name = std::filesystem::path(name).filename().string();
  const std::filesystem::path base = source_.home() / (folder.empty() ? compiler_.assetFolder : folder);
  return source_.folders().find(base, name, tag.path("file"));
}

void MjcfReader::readModel(const Tag& tag) {
  const std::filesystem::path file = source_.folders().find(source_.home(), tag.need("file"),
                                                            tag.path("file"));
  const std::string name = tag.name().empty() ? file.stem().string() : tag.name();
  if (!attached_.emplace(name, file).second)
    tag.fail("name", "a name that no other model has", "\"" + name + "\"");
}

void MjcfReader::readMesh(const Tag& tag) {
  std::string name = tag.name();
  MjcfMesh asset;
  asset.place = tag.place();
  TriangleMesh& mesh = asset.mesh;
  if (tag.has("builtin")) {
    report_.note(Effect::Lost, tag.place(), "mesh" + inQuotes(name), "meshes that MuJoCo generates");
    return;
  }
  if (tag.has("file")) {
    const std::filesystem::path file = assetFile(tag, compiler_.meshFolder);
    if (name.empty()) name = file.stem().string();
    const io::MeshFile content = io::readMesh(file.string());
    mesh = content.surface();
  } else if (const auto numbers = tag.numbers("vertex", 3, kMostNumbers)) {
    if (numbers->size() % 3 != 0)
      tag.fail("vertex", "three numbers for each vertex", std::to_string(numbers->size()));
    for (std::size_t i = 0; i < numbers->size(); i += 3)
      mesh.vertices.push_back({(*numbers)[i], (*numbers)[i + 1], (*numbers)[i + 2]});
    if (const auto faces = tag.numbers("face", 3, kMostNumbers)) {
      const auto count = static_cast<double>(mesh.vertices.size());
      if (faces->size() % 3 != 0)
        tag.fail("face", "three vertices for each face", std::to_string(faces->size()));
      for (std::size_t i = 0; i < faces->size(); ++i) {
        const double v = (*faces)[i];
        if (!(v >= 0 && v < count) || v != static_cast<double>(static_cast<int>(v)))
          tag.fail("face", "indices of vertices below " + std::to_string(mesh.vertices.size()),
                   std::to_string(v));
        if (i % 3 == 0) mesh.triangles.emplace_back();
        mesh.triangles.back()[i % 3] = static_cast<int>(v);
      }
    }
  } else {
    tag.fail("file", "a file or vertices", "none");
  }
  if (name.empty()) tag.fail("name", "a name", "none");
  if (meshes_.contains(name)) tag.fail("name", "a name that no other mesh has", "\"" + name + "\"");
  const Vec3 scale = tag.vector("scale").value_or(Vec3{1, 1, 1}),
             origin = tag.vector("refpos").value_or(Vec3{});
  const Quat turn = quaternionOf(tag, "refquat").value_or(Quat{});
  for (Vec3& v : mesh.vertices) v = mul(rotateInverse(turn, v - origin), scale);
  if (scale.x * scale.y * scale.z < 0)
    for (std::array<int, 3>& t : mesh.triangles) std::swap(t[1], t[2]);
  if (mesh.triangles.empty()) mesh = hullOf(mesh.vertices, tag.path("vertex"));
  asset.mass = static_cast<MeshMass>(tag.choice("inertia", {"exact", "legacy", "convex", "shell"},
                                                static_cast<std::size_t>(compiler_.meshMass)));
  asset.drawn = drawnMesh(mesh);
  asset.material = tag.text("material").value_or("");
  meshes_.emplace(name, std::move(asset));
}

void MjcfReader::readHeightField(const Tag& tag) {
  MjcfHeightField field;
  std::string name = tag.name();
  const auto size = tag.numbers("size", 4, 4);
  if (!size) tag.fail("size", "four numbers", "none");
  field.radiusX = (*size)[0], field.radiusY = (*size)[1], field.height = (*size)[2];
  if (!(field.radiusX > 0 && field.radiusY > 0 && field.height >= 0))
    tag.fail("size", "radii above 0 and a height of at least 0", "others");
  if (tag.has("file")) {
    const std::filesystem::path file = assetFile(tag, "");
    if (name.empty()) name = file.stem().string();
    field.samples = file.extension() == ".png" ? pictureSamples(file, field, tag.path("file"))
                                               : readSamples(file, field, tag.path("file"));
  } else {
    field.rows = tag.whole("nrow", 2, kMostSamples).value_or(0);
    field.columns = tag.whole("ncol", 2, kMostSamples).value_or(0);
    if (field.rows == 0 || field.columns == 0) tag.fail("nrow", "numbers of rows and columns", "none");
    const auto count = static_cast<std::size_t>(field.rows) * static_cast<std::size_t>(field.columns);
    const auto heights = tag.numbers("elevation", count, count);
    field.samples.assign(count, 0);
    // the first row of the attribute is the one of the largest y
    const auto columns = static_cast<std::size_t>(field.columns), rows = static_cast<std::size_t>(field.rows);
    for (std::size_t i = 0; heights && i < count; ++i)
      field.samples[(rows - 1 - i / columns) * columns + i % columns] = (*heights)[i];
  }
  normalizeSamples(field.samples);
  fields_[name] = std::move(field);
}

}  // namespace rubble::convert
