#pragma once
/// A glTF file as JSON with its buffers.
#include <optional>
#include <string>
#include <vector>

#include <rubble/mesh.h>
#include <nlohmann/json.hpp>

#include "convert/folders.h"

namespace rubble::convert {

using GltfJson = nlohmann::json;

class GltfFile {
 public:
  /// Throws Error for files that are no glTF.
  GltfFile(const std::string& bytes, const std::string& file);
  const GltfJson& json() const { return json_; }
  const std::string& name() const { return file_; }
  /// Entry of a list of the root, or of an extension of it; throws Error at `who`.
  const GltfJson& entry(const GltfJson& list, const GltfJson& index, const std::string& who) const;
  static const GltfJson& child(const GltfJson& object, const char* key);
  /// Triangles of all primitives of a mesh, or of one of them. Throws Error.
  TriangleMesh mesh(const GltfJson& index, const std::string& who, Folders& folders,
                    std::optional<std::size_t> primitive = {});

 private:
  const std::string& buffer(std::size_t index, const std::string& who, Folders& folders);
  std::vector<double> numbers(const GltfJson& accessor, std::size_t components, const std::string& who,
                              Folders& folders);

  std::string file_, binary_;
  GltfJson json_;
  std::vector<std::string> buffers_;
};

}  // namespace rubble::convert
