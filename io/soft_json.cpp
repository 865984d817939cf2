#include "io/soft_json.h"

#include <bit>

#include "cook/soft_fields.h"
#include "forces/element_kind.h"
#include "io/field_json.h"
#include "io/soft_mesh.h"

namespace rubble::io {
namespace {

using Ordered = nlohmann::ordered_json;
template <std::size_t N> using Tuples = std::vector<std::array<int, N>>;

std::optional<int> vertexIndex(const Node& node) { return node.whole(0, "the index of a vertex, from 0"); }

/// Reads the field of each key, if it is there.
class FieldReader {
 public:
  FieldReader(ObjectReader& object, const std::function<Material(const Node&)>& material)
      : object_(object), material_(material) {}

  template <class T> void operator()(const char* key, const char*, const char*, T& out) {
    if (const auto node = object_.get(key)) read(*node, out);
  }

 private:
  static void read(const Node& node, std::string& out) { out = node.text().value_or(out); }
  static void read(const Node& node, bool& out) { out = node.boolean().value_or(out); }
  static void read(const Node& node, Vec3& out) { out = node.vector().value_or(out); }
  static void read(const Node& node, double& out) {
    // unbounded values may be given as a word
    const bool word = node.value().isText("hard") || node.value().isText("never");
    if (!(word && std::isinf(out))) out = node.number().value_or(out);
  }
  static void read(const Node& node, std::optional<double>& out) { out = node.number(); }
  static void read(const Node& node, std::optional<Vec3>& out) { out = node.vector(); }
  void read(const Node& node, Material& out) { out = material_(node); }
  static void read(const Node& node, std::vector<Vec3>& out) {
    for (const Node& element : node.elements("a list of points"))
      out.push_back(element.vector().value_or(Vec3{}));
  }
  static void read(const Node& node, std::vector<double>& out) {
    for (const Node& element : node.elements("a list of numbers"))
      out.push_back(element.number().value_or(0));
  }
  static void read(const Node& node, std::vector<int>& out) {
    for (const Node& element : node.elements("a list of vertices"))
      out.push_back(vertexIndex(element).value_or(0));
  }
  template <std::size_t N> static void read(const Node& node, Tuples<N>& out) {
    const std::string what = "a list of " + std::to_string(N) + " vertices";
    for (const Node& element : node.elements("a list of lists of vertices")) {
      const std::vector<Node> corners = element.elements(what.c_str());
      if (corners.size() != N) {
        element.fault(what);
        continue;
      }
      auto& tuple = out.emplace_back();
      for (std::size_t k = 0; k < N; ++k) tuple[k] = vertexIndex(corners[k]).value_or(0);
    }
  }
  static void read(const Node& node, std::vector<NetDef::Edge>& out) {
    constexpr const char* kEdge = "[vertex, vertex, stiffness, damping, rest length], the last two if wanted";
    for (const Node& element : node.elements("a list of springs")) {
      const std::vector<Node> parts = element.elements(kEdge);
      if (parts.size() < 3 || parts.size() > 5) {
        element.fault(kEdge);
        continue;
      }
      NetDef::Edge edge{vertexIndex(parts[0]).value_or(0), vertexIndex(parts[1]).value_or(0),
                        parts[2].number().value_or(1)};
      if (parts.size() > 3) edge.damping = parts[3].number().value_or(0);
      if (parts.size() > 4) edge.restLength = parts[4].number().value_or(-1);
      out.push_back(edge);
    }
  }

  ObjectReader& object_;
  const std::function<Material(const Node&)>& material_;
};

/// Values as files have them.
Ordered jsonOf(const Vec3& v) { return {v.x, v.y, v.z}; }
Ordered jsonOf(const NetDef::Edge& e) {
  Ordered json{e.a, e.b, e.stiffness};
  if (e.damping != 0 || e.restLength >= 0) json.push_back(e.damping);
  if (e.restLength >= 0) json.push_back(e.restLength);
  return json;
}
template <class T> Ordered jsonOf(const T& value) { return value; }

/// -0 is not 0 in a file.
bool usual(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }
bool usual(const Vec3& a, const Vec3& b) { return usual(a.x, b.x) && usual(a.y, b.y) && usual(a.z, b.z); }
bool usual(bool a, bool b) { return a == b; }
bool usual(const std::string& a, const std::string& b) { return a == b; }
template <class T> bool usual(const std::optional<T>& a, const std::optional<T>&) { return !a; }
template <class T> bool usual(const std::vector<T>& a, const std::vector<T>&) { return a.empty(); }

/// Writes the fields that are not as a new object has them. `usualValues` gives the fields of one in the same
/// order.
class FieldWriter {
 public:
  FieldWriter(Ordered& json, const Ordered& material) : json_(json), material_(material) {}

  template <class T> void write(const char* key, const T& value, const T& usualValue) {
    if constexpr (std::is_same_v<T, Material>) {
      if (!material_.is_null()) json_[key] = material_;
    } else if (!usual(value, usualValue)) {
      put(key, value);
    }
  }

 private:
  template <class T> void put(const char* key, const std::optional<T>& value) { json_[key] = jsonOf(*value); }
  template <class T> void put(const char* key, const std::vector<T>& values) {
    json_[key] = Ordered::array();
    for (const T& value : values) json_[key].push_back(jsonOf(value));
  }
  template <class T> void put(const char* key, const T& value) { json_[key] = jsonOf(value); }

  Ordered& json_;
  const Ordered& material_;
};

/// Calls use(key, value, usual value) for each field of `def` that `visit` lists.
template <class D, class Visit, class Use> void besideUsual(const D& def, Visit&& visit, Use&& use) {
  const D fresh;
  visit(def, [&](const char* key, const char*, const char*, const auto& value) {
    visit(fresh, [&](const char* other, const char*, const char*, const auto& usualValue) {
      if constexpr (std::is_same_v<decltype(value), decltype(usualValue)>)
        if (std::string_view(key) == other) use(key, value, usualValue);
    });
  });
}

constexpr auto kAllFields = [](auto& def, auto&& f) { commonFields(def, f), ownFields(def, f); };
constexpr auto kFieldsOfAttachment = [](auto& def, auto&& f) { attachmentFields(def, f); };

/// The index of an object of the scene, by index or name.
int objectIndex(const Node& node, const std::vector<Deformable>& objects) {
  if (node.value().isInteger()) {
    const auto index = node.whole(0, "the index of a deformable object, from 0");
    if (index && *index < static_cast<int>(objects.size())) return *index;
    if (index) node.fault("the index of one of " + std::to_string(objects.size()) + " deformable objects");
    return 0;
  }
  const auto name = node.text();
  std::vector<std::string> names;
  for (std::size_t i = 0; name && i < objects.size(); ++i) {
    names.push_back(common(objects[i]).name);
    if (names.back() == *name) return static_cast<int>(i);
  }
  if (name)
    node.faultText("expected the name or index of a deformable object, got " + describe(node.value()) +
                   hint(*name, names));
  return 0;
}

std::vector<ElementDef> readElements(const Node& node) {
  std::vector<std::string> names;
  for (const ElementKind& kind : elementKinds()) names.emplace_back(kind.name);
  std::vector<ElementDef> out;
  for (const Node& each : node.elements("a list of elements")) {
    ObjectReader object(each, "an element");
    const auto type = object.need("type", "the keyword of an element");
    const auto kind = type ? type->choice(names) : std::nullopt;
    if (!kind) continue;
    ElementDef& def = out.emplace_back(ElementDef{names[*kind], {}, {}});
    if (const auto list = object.need("vertices", "its vertices"))
      for (const Node& v : list->elements("a list of vertices"))
        def.vertices.push_back(vertexIndex(v).value_or(0));
    for (const ElementField& field : elementKinds()[*kind].fields)
      field.visit(def, [&](auto& value) { readField(object, field, value); });
    object.finish();
  }
  return out;
}

Ordered elementJson(const ElementDef& def) {
  Ordered json{{"type", def.type}, {"vertices", def.vertices}};
  for (const ElementField& field : findElementKind(def.type)->fields)
    field.visit(def, ElementDef{}, [&](const auto& value, const auto& usualValue) {
      if (!sameBits(value, usualValue) || field.rules.always) json[field.key] = fieldJson(field, value);
    });
  return json;
}

}  // namespace

Deformable readDeformable(const Node& node, const std::function<Material(const Node&)>& material,
                          const std::string& folder) {
  Deformable out;
  ObjectReader object(node, "a deformable object");
  if (!object.isObject()) return out;
  const auto type = object.need("type", "\"tet_solid\", \"cloth\", \"cable\", \"net\" or \"particles\"");
  if (!type) return out;
  const auto kind = type->choice({std::begin(kDeformableKeywords), std::end(kDeformableKeywords)});
  if (!kind) return out;
  if (*kind == 1)
    out = ClothDef{};
  else if (*kind == 2)
    out = CableDef{};
  else if (*kind == 3)
    out = NetDef{};
  else if (*kind == 4)
    out = ParticlesDef{};
  std::visit([&](auto& def) { kAllFields(def, FieldReader(object, material)); }, out);
  if (!elementKinds().empty())
    if (const auto list = object.get("elements")) common(out).elements = readElements(*list);
  if (const auto mesh = object.get("mesh")) readMeshInto(*mesh, folder, out);
  object.finish();
  return out;
}

AttachmentDef readAttachment(const Node& node, const std::vector<Deformable>& objects,
                             const std::function<int(const Node&)>& body) {
  AttachmentDef out;
  ObjectReader object(node, "an attachment");
  if (!object.isObject()) return out;
  if (const auto found = object.need("object", "the name or index of a deformable object"))
    out.object = objectIndex(*found, objects);
  if (const auto found = object.get("body")) out.body = body(*found);
  if (const auto found = object.get("other_object")) out.otherObject = objectIndex(*found, objects);
  kFieldsOfAttachment(out, FieldReader(object, {}));
  object.finish();
  return out;
}

AttachmentDef readAttachment(const Node& node) {
  AttachmentDef out;
  ObjectReader object(node, "an attachment");
  if (!object.isObject()) return out;
  kFieldsOfAttachment(out, FieldReader(object, {}));
  object.finish();
  return out;
}

Ordered deformableJson(const Deformable& object, const Ordered& material) {
  Ordered json = Ordered::object();
  json["type"] = kDeformableKeywords[object.index()];
  FieldWriter writer(json, material);
  std::visit(
      [&](const auto& def) {
        besideUsual(def, kAllFields, [&](const char* key, const auto& value, const auto& usualValue) {
          writer.write(key, value, usualValue);
        });
      },
      object);
  for (const ElementDef& def : common(object).elements) json["elements"].push_back(elementJson(def));
  return json;
}

Ordered attachmentJson(const AttachmentDef& attachment, const Ordered& body) {
  Ordered json = Ordered::object();
  json["object"] = attachment.object;
  if (attachment.body != kWorld) json["body"] = body;
  if (attachment.otherObject >= 0) json["other_object"] = attachment.otherObject;
  FieldWriter writer(json, nullptr);
  besideUsual(attachment, kFieldsOfAttachment,
              [&](const char* key, const auto& value, const auto& usualValue) {
                writer.write(key, value, usualValue);
              });
  return json;
}

}  // namespace rubble::io
