#include "convert/usd/layer.h"

#include <algorithm>

namespace rubble::usd {

Prim* Prim::child(const std::string& wanted) const {
  for (const auto& each : children)
    if (each->name == wanted) return each.get();
  return nullptr;
}
const Property* Prim::find(const std::string& wanted) const {
  for (const Property& each : properties)
    if (each.name == wanted) return &each;
  return nullptr;
}
bool Prim::hasSchema(const std::string& wanted) const {
  return std::find(schemas.begin(), schemas.end(), wanted) != schemas.end();
}

std::unique_ptr<Prim> Prim::copy() const {
  auto out = std::make_unique<Prim>();
  out->name = name, out->type = type, out->kind = kind, out->active = active, out->schemas = schemas;
  out->properties = properties, out->references = references, out->inherits = inherits;
  out->selections = selections, out->file = file, out->line = line;
  for (const auto& each : children) out->children.push_back(each->copy());
  for (const auto& [set, choices] : variants)
    for (const auto& [choice, content] : choices) out->variants[set][choice] = content->copy();
  return out;
}

Layer parse(const std::string& bytes, const std::string& file) {
  return bytes.starts_with("PXR-USDC") ? parseCrate(bytes, file) : parseText(bytes, file);
}

}  // namespace rubble::usd
