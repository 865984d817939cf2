/// Every field of what is selected, with its unit.
#include <algorithm>
#include <cmath>

#include <imgui/imgui.h>

#include "apps/viewer/panel_parts.h"
#include "apps/viewer/ui_state.h"
#include "cook/soft_fields.h"
#include "forces/joint_kind.h"
#include "io/picture_values.h"
#include "io/shape_json.h"

namespace rubble::viewer {
namespace {

std::string nameOf(const World& world, BodyId id) {
  if (id.index < 0) return "the world";
  if (!world.alive(id)) return "a removed body";
  const std::string& name = world.definition(id).name;
  return name.empty() ? "body " + std::to_string(id.index) : name;
}
const char* wordOf(Motion motion) {
  return motion == Motion::Static ? "static" : motion == Motion::Kinematic ? "kinematic" : "dynamic";
}
std::string bitsOf(std::uint32_t bits) {
  char text[16];
  std::snprintf(text, sizeof text, "0x%08x", bits);
  return text;
}
std::string axesOf(const std::array<bool, 3>& axes) {
  std::string text;
  for (std::size_t i = 0; i < 3; ++i)
    if (axes[i]) text += "xyz"[i];
  return text.empty() ? "none" : text;
}
void turnRow(const char* name, const Quat& q, const char* doc = "scalar first") {
  char text[80];
  std::snprintf(text, sizeof text, "%8.4f %8.4f %8.4f %8.4f", q.s, q.v.x, q.v.y, q.v.z);
  row(name, std::string(text), doc);
}

void materialRows(const Material& m, bool ofBody) {
  static constexpr const char* kRules[] = {"usual",    "average", "minimum",
                                           "multiply", "maximum", "geometric mean"};
  row("static friction", "1", m.staticFriction);
  row("dynamic friction", "1", m.dynamicFriction);
  row("restitution", "1", m.restitution);
  row("friction combines", kRules[static_cast<int>(m.frictionCombine)]);
  row("restitution combines", kRules[static_cast<int>(m.restitutionCombine)]);
  if (!ofBody) return;
  row("rolling friction", "m", m.rollingFriction);
  row("torsional friction", "m", m.torsionalFriction);
  row("surface velocity", "m/s", m.surfaceVelocity);
}

void shapeRows(const Shape& shape) {
  const nlohmann::ordered_json json = io::shapeJson(shape);
  for (const auto& [key, value] : json.items()) {
    const std::string text = value.dump();
    constexpr std::size_t kLongest = 60;
    row(("shape " + key).c_str(), text.size() > kLongest ? std::to_string(value.size()) + " entries" : text,
        "[m]");
  }
}

void solverRows(const SolverState& state) {
  if (state.color < 0)
    row("color", std::string("none"));
  else
    row("color", "1", state.color, "bodies of one color are solved at the same time");
  row("stiffness k", "N/m", state.stiffness, "largest of the rows that act here");
  row("multiplier |lambda|", "N", state.multiplier, "largest of the rows that act here");
}

void contactRows(const World& world, BodyId id) {
  const ContactLoad load = world.contactLoad(id);
  row("contact force", "N", load.force, "of all contacts");
  row("contact torque", "N m", load.torque, "about the center");
  row("residual", "m", load.residual, "deepest penetration that is left");
  if (load.points == 0 || !ImGui::TreeNode("contacts", "%d contact points", load.points)) return;
  for (const ContactPoint& c : world.contacts()) {
    if (c.a != id && c.b != id) continue;
    const bool isB = c.b == id;
    row(nameOf(world, isB ? c.a : c.b).c_str(), "N", isB ? c.force : -c.force);
    row("  depth", "m", c.depth);
  }
  ImGui::TreePop();
}

void drawBody(UiState& uiState, Player& player, BodyId id) {
  World& world = player.world();
  const BodyDef& body = world.definition(id);
  const BodyState state = world.state(id);
  const MassProperties mass = world.massOf(id);
  ImGui::Text("%s (index %d), %s%s", nameOf(world, id).c_str(), static_cast<int>(id.index),
              wordOf(body.motion), world.asleep(id) ? ", asleep" : "");
  row("position", "m", state.position);
  turnRow("orientation", state.orientation);
  row("velocity", "m/s", state.velocity);
  row("angular velocity", "rad/s", state.angularVelocity);
  if (player.sides() == 2 && player.world(1).alive(id))
    row("apart from the right", "m", length(player.world(1).state(id).position - state.position));
  ImGui::Separator();
  contactRows(world, id);
  const std::vector<BodyId> bodies = world.bodies();
  const auto at = std::find(bodies.begin(), bodies.end(), id) - bodies.begin();
  solverRows(world.solverStates()[static_cast<std::size_t>(at)]);
  for (const JointId joint : world.joints()) {
    const auto ends = world.bodiesOf(joint);
    if (ends[0] != id && ends[1] != id) continue;
    const JointDef& def = world.definition(joint);
    const std::string label = std::string(keyword(def.type)) + " " + def.name + "##" +
                              std::to_string(joint.index);
    if (ImGui::SmallButton(label.c_str())) uiState.selection = {std::nullopt, joint, std::nullopt, -1};
    ImGui::SameLine();
    ImGui::Text("to %s", nameOf(world, ends[0] == id ? ends[1] : ends[0]).c_str());
  }
  if (!ImGui::CollapsingHeader("As authored")) return;
  shapeRows(body.shape);
  row("mass", "kg", mass.mass);
  row("inertia", "kg m2", mass.inertia, "about the principal axes");
  row("center of mass", "m", mass.center, "in the frame of the shape");
  turnRow("principal axes", mass.axes);
  row("density", "kg/m3", body.density);
  materialRows(body.material, true);
  row("gravity scale", "1", body.gravityScale);
  row("linear damping", "1/s", body.linearDamping);
  row("angular damping", "1/s", body.angularDamping);
  row("locked translation", axesOf(body.lockTranslation));
  row("locked rotation", axesOf(body.lockRotation));
  row("layers", bitsOf(body.filter.layers));
  row("mask", bitsOf(body.filter.mask));
  row("group", "1", body.filter.group);
  row("sensor", std::string(body.sensor ? "yes" : "no"));
}

/// Number of a field, with the word for infinity.
void fieldRow(const FieldInfo& field, double value) {
  if (std::isinf(value) && field.rules.infinity)
    row(field.key, std::string(value < 0 ? "-" : "") + field.rules.infinity, field.doc);
  else
    row(field.key, field.unit, value, field.doc);
}
void fieldRow(const FieldInfo& field, bool value) {
  row(field.key, std::string(value ? "yes" : "no"), field.doc);
}
void fieldRow(const FieldInfo& field, const Vec3& value) { row(field.key, field.unit, value, field.doc); }
void fieldRow(const FieldInfo& field, const Quat& value) { turnRow(field.key, value, field.doc); }
void fieldRow(const FieldInfo& field, const std::vector<double>& value) {
  row(field.key, std::to_string(value.size()) + " numbers", field.doc);
}

void drawJoint(UiState& uiState, World& world, JointId id) {
  const JointDef& def = world.definition(id);
  const JointState state = world.state(id);
  const auto ends = world.bodiesOf(id);
  ImGui::Text("%s %s%s", keyword(def.type), def.name.c_str(), state.broken ? ", broken" : "");
  for (const BodyId end : ends) {
    if (end.index >= 0 && world.alive(end)) {
      if (ImGui::SmallButton(nameOf(world, end).c_str()))
        uiState.selection = {end, std::nullopt, std::nullopt, -1};
    } else {
      ImGui::TextUnformatted("the world");
    }
    if (end == ends[0]) ImGui::SameLine();
  }
  row("gap", "m", state.gap, "residual of what is held or limited in metres");
  row("angle", "rad", state.angle, "residual of what is held or limited in angles");
  row("force", "N", state.force, "on B, at its anchor");
  row("torque", "N m", state.torque, "on B, about its anchor");
  for (std::size_t i = 0; i < state.axes.size(); ++i) {
    const JointAxisState& axis = state.axes[i];
    ImGui::Text("axis %zu", i);
    row("  position", "m, rad", axis.position);
    row("  speed", "m/s, rad/s", axis.speed);
    row("  limit force", "N, N m", axis.limitForce);
    row("  drive force", "N, N m", axis.driveForce);
    row("  friction force", "N, N m", axis.frictionForce);
    row("  motor force", "N, N m", axis.motorForce);
  }
  if (!ImGui::CollapsingHeader("As authored", ImGuiTreeNodeFlags_DefaultOpen)) return;
  const JointKind& kind = kindOf(def.type);
  for (const JointField& field : kind.fields)
    field.visit(def, [&](const auto& value) { fieldRow(field, value); });
  row("collide", std::string(def.collide ? "yes" : "no"));
  for (int i = 0; i < kind.axes; ++i) {
    ImGui::Text("axis %d", i);
    forEachField(kAxisFields, def.axes[static_cast<std::size_t>(i)],
                 [](const FieldInfo& field, double value) { fieldRow(field, value); });
  }
}

/// Numbers of a deformable object; lists by their length.
struct FieldRows {
  template <class T>
  void operator()(const char* key, const char* unit, const char* doc, const T& value) const {
    if constexpr (std::is_same_v<T, bool>)
      row(key, std::string(value ? "yes" : "no"), doc);
    else if constexpr (std::is_arithmetic_v<T>)
      row(key, unit, static_cast<double>(value), doc);
    else if constexpr (std::is_same_v<T, Vec3>)
      row(key, unit, value, doc);
    else if constexpr (std::is_same_v<T, std::string>)
      row(key, value, doc);
    else if constexpr (std::is_same_v<T, std::optional<double>>)
      value ? row(key, unit, *value, doc) : row(key, std::string("not given"), doc);
    else if constexpr (requires { value.size(); })
      row(key, std::to_string(value.size()) + " entries", doc);
  }
};

void drawObject(UiState& uiState, World& world, DeformableId id) {
  const Deformable& def = world.definition(id);
  ImGui::Text("%s %s (index %d), %d vertices", kDeformableKeywords[def.index()], common(def).name.c_str(),
              static_cast<int>(id.index), world.vertexCount(id));
  const auto v = static_cast<std::size_t>(uiState.selection.vertex);
  if (v < world.positions(id).size()) {
    ImGui::Text("vertex %zu", v);
    row("position", "m", world.positions(id)[v]);
    row("velocity", "m/s", world.velocities(id)[v]);
    row("mass", "kg", world.masses(id)[v]);
    solverRows(world.solverStates(id)[v]);
    const std::vector<DeformableId> objects = world.deformables();
    const auto at = std::find(objects.begin(), objects.end(), id) - objects.begin();
    row("strain", "1",
        static_cast<double>(io::vertexValues(world, io::ColorBy::Strain)[static_cast<std::size_t>(at)][v]));
    for (const VertexContact& c : world.vertexContacts())
      if (c.object == id && c.vertex == uiState.selection.vertex)
        row("contact force", "N", c.force), row("  depth", "m", c.depth);
  }
  if (!ImGui::CollapsingHeader("As authored", ImGuiTreeNodeFlags_DefaultOpen)) return;
  commonFields(common(def), FieldRows{});
  materialRows(common(def).material, false);
  std::visit([](const auto& own) { ownFields(own, FieldRows{}); }, def);
}

}  // namespace

void drawInspector(UiState& uiState, Player& player) {
  World& world = player.world();
  Selection& s = uiState.selection;
  if (s.body && !world.alive(*s.body)) s.body.reset();
  if (s.joint && !world.alive(*s.joint)) s.joint.reset();
  if (s.object && !world.alive(*s.object)) s.object.reset();
  if (!s.any()) return;
  const ImVec2 size = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({size.x - kMargin, kMargin}, ImGuiCond_Once, {1, 0});
  ImGui::SetNextWindowSizeConstraints({0, 0}, {size.x, size.y - 90});
  ImGui::Begin("Inspector", nullptr, kPlain);
  if (s.body)
    drawBody(uiState, player, *s.body);
  else if (s.joint)
    drawJoint(uiState, world, *s.joint);
  else
    drawObject(uiState, world, *s.object);
  ImGui::End();
}

}  // namespace rubble::viewer
