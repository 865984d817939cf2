#pragma once
/// Deformable objects and attachments of scene files.
#include <functional>

#include <nlohmann/json.hpp>

#include "io/json_reader.h"

namespace rubble::io {

/// `material` reads one, or looks up its name. `folder`: where mesh files are looked for.
Deformable readDeformable(const Node& node, const std::function<Material(const Node&)>& material,
                          const std::string& folder = "");
/// `body` reads a reference to a body; `objects` are those of the scene.
AttachmentDef readAttachment(const Node& node, const std::vector<Deformable>& objects,
                             const std::function<int(const Node&)>& body);

/// An attachment without the objects and the body that it refers to.
AttachmentDef readAttachment(const Node& node);

/// `material`: how the file names that of the object; null for the usual one.
nlohmann::ordered_json deformableJson(const Deformable& object, const nlohmann::ordered_json& material);
/// `body`: how the file refers to it.
nlohmann::ordered_json attachmentJson(const AttachmentDef& attachment, const nlohmann::ordered_json& body);

}  // namespace rubble::io
