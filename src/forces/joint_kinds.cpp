/// The table of joint kinds and the parts of conversions that they share.
#include "forces/joint_kind.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include <rubble/error.h>

#include "forces/forces.h"

namespace rubble {

namespace host {
namespace {

template <class F> constexpr int axisCount() {
  int axes = 0;
  forEachPart<F>([&]<int, class P>() { axes += P::kAxis; });
  return axes;
}

/// Where a definition has the fields of a struct: JointDef itself, or the one in JointDef::own.
struct InJoint {
  template <class Owner, class Def> static auto& owner(Def& def) {
    if constexpr (std::is_same_v<Owner, JointDef>)
      return def;
    else
      return ownIn<Owner>(def.own);
  }
};

template <class K> void checkKind(const JointDef& def, const Path& path) {
  const auto isOwn = [&]<class O, class T>(const Field<O, T>&) { return def.own.type() == typeid(O); };
  if (def.own.has_value() && !std::apply([&](const auto&... f) { return (isOwn(f) || ...); }, K::kFields))
    throw Error(path + ".own", std::string("the fields of a joint of type ") + K::kName, "others");
  if constexpr (requires { K::check(def, path); }) K::check(def, path);
}

template <class K, class Joints>
EngineJoint buildKind(const JointDef& def, const JointBodies& bodies, const EngineJoint* before) {
  JointBuild build{def, bodies, before, {}};
  EngineJoint& joint = build.joint;
  joint.type = typeIndex<typename K::Joint>(Joints{});
  if constexpr (requires { K::template engineType<Joints>(def); })
    joint.type = K::template engineType<Joints>(def);
  joint.alive = true;
  joint.anchorA = def.anchorA, joint.anchorB = def.anchorB;
  joint.frameA = normalize(def.frameA), joint.frameB = normalize(def.frameB);
  joint.aToB = normalize(def.orientationAtoB);
  joint.breakForce = def.breakForce, joint.breakTorque = def.breakTorque;
  joint.axes.assign(def.axes.begin(), def.axes.begin() + axisCount<typename K::Joint>());
  K::build(build);
  return std::move(joint);
}

template <class K, class Joints> JointKind describeKind() {
  using F = typename K::Joint;
  JointKind kind;
  kind.name = K::kName, kind.doc = K::kDoc;
  kind.rows = rowCount<F>(), kind.axes = axisCount<F>();
  if constexpr (requires { K::kRows; }) kind.rows = K::kRows;
  bool linear = false, angular = false;
  forEachPart<F>([&]<int, class P>() {
    if (P::kAxis) (P::kUnit == RowUnit::Linear ? linear : angular) = true;
  });
  kind.axisUnit = linear && angular ? "m, rad" : linear ? "m" : "rad";
  kind.hasFrameBodies = hasFrameBodies<F>();
  kind.fields = anyFields<JointDef, K, InJoint>();
  std::size_t at = 0;
  const auto sort = [&]<class O, class T>(const Field<O, T>&) {
    if (!std::is_same_v<O, JointDef>) kind.ownFields.push_back(kind.fields[at]);
    ++at;
  };
  std::apply([&](const auto&... f) { (sort(f), ...); }, K::kFields);
  kind.build = buildKind<K, Joints>;
  kind.check = checkKind<K>;
  return kind;
}

/// The kinds of a list, by JointType. Kinds without an enumerator follow, in list order.
template <class... K> std::vector<JointKind> describeKinds(TypeList<K...>) {
  constexpr int kNamed = static_cast<int>(((requires { K::kType; }) + ... + 0));
  std::vector<JointKind> kinds(sizeof...(K));
  int next = kNamed;
  const auto add = [&]<class Kind>() {
    int at = next;
    if constexpr (requires { Kind::kType; })
      at = static_cast<int>(Kind::kType);
    else
      ++next;
    kinds[static_cast<std::size_t>(at)] = describeKind<Kind, Unique<typename K::Joint...>>();
    kinds[static_cast<std::size_t>(at)].type = static_cast<JointType>(at);
  };
  (add.template operator()<K>(), ...);
  return kinds;
}

}  // namespace
}  // namespace host

namespace {

/// Reduced mass of two bodies. If one of them is static it is the mass of the other.
double reduced(double a, double b) { return a > 0 && b > 0 ? a * b / (a + b) : std::max(a, b); }

/// Mean moment of inertia about all axes through the anchor.
double momentAbout(const JointBodyState& body, const Vec3& anchor) {
  if (!(body.mass.mass > 0)) return 0;
  const Vec3 lever = rotate(body.orientation, anchor);
  const Vec3& i = body.mass.inertia;
  return (i.x + i.y + i.z) / 3 + body.mass.mass * 2 * dot(lever, lever) / 3;
}

double damperOf(double damping, double ratio, double stiffness, double inertia) {
  return ratio > 0 ? 2 * ratio * std::sqrt(stiffness * inertia) : damping;
}

}  // namespace

std::string numberText(double a) {
  std::ostringstream out;
  out << a;
  return out.str();
}

Vec3 JointBodyState::point(const Vec3& local) const { return position + rotate(orientation, local); }

double JointBuild::mass() const { return reduced(bodies.a.mass.mass, bodies.b.mass.mass); }
double JointBuild::moment() const {
  return reduced(momentAbout(bodies.a, def.anchorA), momentAbout(bodies.b, def.anchorB));
}
double JointBuild::damping() const { return damperOf(def.damping, def.dampingRatio, def.stiffness, mass()); }
EngineGroup JointBuild::anchors() const { return {GroupMode::Hold, def.stiffness, damping(), def.maxForce}; }
EngineGroup JointBuild::orientation() const {
  return {GroupMode::Hold, def.angularStiffness,
          damperOf(def.angularDamping, def.angularDampingRatio, def.angularStiffness, moment()),
          def.maxTorque};
}
EngineGroup JointBuild::friction() const {
  return def.friction > 0 ? EngineGroup{GroupMode::Friction, kHard, 0, def.friction} : off();
}
double JointBuild::lengthOr(double now) const {
  if (def.length >= 0) return def.length;
  return before ? before->axes[0].targetPosition : now;
}

const std::vector<JointKind>& jointKinds() {
  static const std::vector<JointKind> kinds = host::describeKinds(host::JointKinds{});
  return kinds;
}
const JointKind& kindOf(JointType type) { return jointKinds().at(static_cast<std::size_t>(type)); }

const std::vector<JointField>& sharedJointFields() {
  static const std::vector<JointField> fields = [] {
    const JointDef def;
    const auto place = [&](const JointField& field) {
      const char* at = nullptr;
      field.visit(def, [&](const auto& value) { at = reinterpret_cast<const char*>(&value); });
      return at - reinterpret_cast<const char*>(&def);
    };
    std::vector<JointField> all;
    for (const JointKind& kind : jointKinds())
      for (const JointField& field : kind.fields)
        if (std::none_of(kind.ownFields.begin(), kind.ownFields.end(),
                         [&](auto& f) { return f.is(field.key); }) &&
            std::none_of(all.begin(), all.end(), [&](const JointField& f) { return f.is(field.key); }))
          all.push_back(field);
    std::sort(all.begin(), all.end(),
              [&](const JointField& a, const JointField& b) { return place(a) < place(b); });
    return all;
  }();
  return fields;
}

int engineJointTypes() { return host::JointTypes::kSize; }

}  // namespace rubble
