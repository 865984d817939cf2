#include "convert/gltf_file.h"

#include <cstring>
#include <filesystem>

#include <rubble/error.h>

namespace rubble::convert {
namespace {

constexpr std::size_t kMostComponents = std::size_t{1} << 27;

template <class T> T at(const std::string& bytes, std::size_t offset) {
  T out{};
  if (bytes.size() >= sizeof(T) && offset <= bytes.size() - sizeof(T))
    std::memcpy(&out, bytes.data() + offset, sizeof(T));
  return out;
}

/// Base64 (RFC 4648).
std::string decoded(std::string_view text, const std::string& who) {
  std::string out;
  unsigned bits = 0;
  int count = 0;
  for (const char c : text) {
    if (c == '=') break;
    const int value = c >= 'A' && c <= 'Z'   ? c - 'A'
                      : c >= 'a' && c <= 'z' ? c - 'a' + 26
                      : c >= '0' && c <= '9' ? c - '0' + 52
                      : c == '+'             ? 62
                      : c == '/'             ? 63
                                             : -1;
    if (value < 0) throw Error(who, "base64", "other text");
    bits = bits << 6 | static_cast<unsigned>(value), count += 6;
    if (count >= 8) out.push_back(static_cast<char>(bits >> (count -= 8) & 0xff));
  }
  return out;
}

std::size_t whole(const GltfJson& object, const char* key, std::size_t otherwise, const std::string& who) {
  const GltfJson& value = GltfFile::child(object, key);
  if (value.is_null()) return otherwise;
  if (!value.is_number_integer() || value.get<std::int64_t>() < 0)
    throw Error(who + "." + key, "a whole number of at least 0", value.dump().substr(0, 40));
  return value.get<std::size_t>();
}

}  // namespace

GltfFile::GltfFile(const std::string& bytes, const std::string& file) : file_(file) {
  std::string_view text = bytes;
  constexpr std::uint32_t kMagic = 0x46546c67, kJson = 0x4e4f534a, kBinary = 0x004e4942;
  if (at<std::uint32_t>(bytes, 0) == kMagic) {
    text = {};
    for (std::size_t chunk = 12; chunk + 8 <= bytes.size();) {
      const std::size_t size = at<std::uint32_t>(bytes, chunk), type = at<std::uint32_t>(bytes, chunk + 4);
      if (size > bytes.size() - chunk - 8) throw Error(file, "chunks that are there in full", "less");
      if (type == kJson && text.empty()) text = std::string_view(bytes).substr(chunk + 8, size);
      if (type == kBinary && binary_.empty()) binary_ = bytes.substr(chunk + 8, size);
      chunk += 8 + size;
    }
  }
  try {
    json_ = GltfJson::parse(text);
  } catch (const GltfJson::exception& error) {
    throw Error(file, "well-formed JSON", error.what());
  }
  if (!json_.is_object() || !child(json_, "asset").is_object())
    throw Error(file, "a glTF file", "other JSON");
}

const GltfJson& GltfFile::child(const GltfJson& object, const char* key) {
  static const GltfJson kNone;
  if (!object.is_object()) return kNone;
  const auto found = object.find(key);
  return found == object.end() ? kNone : *found;
}

const GltfJson& GltfFile::entry(const GltfJson& list, const GltfJson& index, const std::string& who) const {
  if (!list.is_array() || !index.is_number_integer() || index.get<std::int64_t>() < 0 ||
      index.get<std::size_t>() >= list.size())
    throw Error(who, "an index that is there", index.dump().substr(0, 40));
  return list[index.get<std::size_t>()];
}

const std::string& GltfFile::buffer(std::size_t index, const std::string& who, Folders& folders) {
  const GltfJson& list = child(json_, "buffers");
  const GltfJson& own = entry(list, index, who);
  buffers_.resize(list.size());
  std::string& bytes = buffers_[index];
  if (!bytes.empty()) return bytes;
  const GltfJson& uri = child(own, "uri");
  if (!uri.is_string()) return binary_;
  const std::string& text = uri.get_ref<const std::string&>();
  if (text.starts_with("data:")) {
    const std::size_t comma = text.find(',');
    if (comma == std::string::npos) throw Error(who, "data in base64", "others");
    bytes = decoded(std::string_view(text).substr(comma + 1), who);
  } else {
    bytes = bytesOf(folders.find(std::filesystem::path(file_).parent_path(), text, who), who);
  }
  return bytes;
}

std::vector<double> GltfFile::numbers(const GltfJson& index, std::size_t components, const std::string& who,
                                      Folders& folders) {
  const GltfJson& accessor = entry(child(json_, "accessors"), index, who);
  if (!child(accessor, "sparse").is_null())
    throw Error(who, "an accessor that is not sparse", "a sparse one");
  const std::size_t type = whole(accessor, "componentType", 0, who), count = whole(accessor, "count", 0, who);
  const std::size_t size = type == 5121 ? 1 : type == 5123 ? 2 : type == 5125 || type == 5126 ? 4 : 0;
  if (size == 0) throw Error(who + ".componentType", "5121, 5123, 5125 or 5126", std::to_string(type));
  if (count > kMostComponents / components)
    throw Error(who + ".count", "fewer elements", std::to_string(count));
  const GltfJson& view = entry(child(json_, "bufferViews"), child(accessor, "bufferView"), who);
  const std::string& bytes = buffer(whole(view, "buffer", 0, who), who, folders);
  const std::size_t offset = whole(view, "byteOffset", 0, who) + whole(accessor, "byteOffset", 0, who),
                    stride = std::max(whole(view, "byteStride", 0, who), size * components);
  if (count > 0 && (offset > bytes.size() || stride > bytes.size() ||
                    (count - 1) * stride + size * components > bytes.size() - offset))
    throw Error(who, "data that is there", "too little");
  std::vector<double> out;
  out.reserve(count * components);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < components; ++k) {
      const std::size_t where = offset + i * stride + k * size;
      out.push_back(type == 5121   ? at<std::uint8_t>(bytes, where)
                    : type == 5123 ? at<std::uint16_t>(bytes, where)
                    : type == 5125 ? at<std::uint32_t>(bytes, where)
                                   : static_cast<double>(at<float>(bytes, where)));
    }
  return out;
}

TriangleMesh GltfFile::mesh(const GltfJson& index, const std::string& who, Folders& folders,
                            std::optional<std::size_t> primitive) {
  TriangleMesh out;
  const GltfJson& mesh = entry(child(json_, "meshes"), index, who);
  std::size_t number = 0;
  for (const GltfJson& part : child(mesh, "primitives")) {
    const std::size_t own = number++;
    if (own != primitive.value_or(own)) continue;
    constexpr std::size_t kTriangles = 4;
    if (whole(part, "mode", kTriangles, who) != kTriangles) continue;
    const auto first = static_cast<int>(out.vertices.size());
    const GltfJson& position = child(child(part, "attributes"), "POSITION");
    const std::vector<double> points = numbers(position, 3, who + ".POSITION", folders);
    for (std::size_t i = 0; i < points.size(); i += 3)
      out.vertices.push_back({points[i], points[i + 1], points[i + 2]});
    std::vector<double> corners;
    if (child(part, "indices").is_null())
      for (std::size_t i = 0; i < points.size() / 3; ++i) corners.push_back(static_cast<double>(i));
    else
      corners = numbers(child(part, "indices"), 1, who + ".indices", folders);
    for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
      std::array<int, 3> t{};
      for (std::size_t k = 0; k < 3; ++k) {
        if (!(corners[i + k] < static_cast<double>(points.size() / 3)))
          throw Error(who + ".indices", "indices of vertices", std::to_string(corners[i + k]));
        t[k] = first + static_cast<int>(corners[i + k]);
      }
      out.triangles.push_back(t);
    }
  }
  return out;
}

}  // namespace rubble::convert
