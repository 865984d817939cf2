#include <rubble/info.h>

#include <build_info.h>

#include "cook/soft_fields.h"
#include "forces/element_kind.h"
#include "forces/joint_kind.h"

namespace rubble {

namespace {

std::string wordOf(const FieldInfo& field) {
  return field.rules.infinity ? std::string(", or \"") + field.rules.infinity + "\"" : "";
}

/// Of "m, rad": the part for lengths or for angles; both for joints that have both.
std::string unitOf(const char* units, const std::string& axisUnit) {
  const std::string both = units;
  const std::size_t comma = both.find(", ");
  return axisUnit == "m" ? both.substr(0, comma) : axisUnit == "rad" ? both.substr(comma + 2) : both;
}

ForceInfo infoOf(const JointKind& kind) {
  ForceInfo info{kind.name, kind.doc, kind.rows, {}, kind.axes, kind.hasFrameBodies};
  for (const JointField& field : kind.fields)
    info.fields.push_back({field.key, field.unit, field.doc + wordOf(field)});
  if (kind.axes > 0)
    forEachField(kAxisFields, JointAxis{}, [&](const FieldInfo& field, double) {
      info.fields.push_back(
          {std::string("axes[].") + field.key, unitOf(field.unit, kind.axisUnit), field.doc + wordOf(field)});
    });
  return info;
}

}  // namespace

std::vector<ForceInfo> forceInfos() {
  std::vector<ForceInfo> infos = {
      {"contact",
       "contact of two bodies with Coulomb friction: one to four points, for each a normal row and two "
       "tangential rows",
       12,
       {{"static_friction", "1", "mu_s; a pair takes the geometric mean"},
        {"dynamic_friction", "1", "mu_d, at most mu_s; a pair takes the geometric mean"},
        {"restitution", "1", "e, for impacts, which close faster than .3 sqrt(g L); a pair takes the larger"},
        {"friction_combine", "1",
         "rule for both frictions of a pair: usual, average, minimum, multiply, maximum, geometric_mean; the "
         "later one wins"},
        {"restitution_combine", "1", "rule for the restitution of a pair"},
        {"surface_velocity", "m/s", "of a belt, body axes"}}},
      {"rolling",
       "rolling and torsional friction of a contact: three rows with moments bounded by a lever times the "
       "normal force",
       3,
       {{"rolling_friction", "m", "lever of the moment that resists rolling; a pair takes the larger"},
        {"torsional_friction", "m",
         "lever of the moment that resists spinning about the normal; a pair takes the larger"}}},
  };
  for (const JointKind& kind : jointKinds()) infos.push_back(infoOf(kind));
  return infos;
}

std::vector<DeformableInfo> deformableInfos() {
  std::vector<DeformableInfo> infos;
  const auto add = [&](const char* name, const char* doc, auto&& visit) {
    DeformableInfo& info = infos.emplace_back(DeformableInfo{name, doc, {}});
    visit([&](const char* key, const char* unit, const char* meaning, const auto&) {
      info.fields.push_back({key, unit, meaning});
    });
  };
  const auto own = [&]<class D>(const D& def, const char* doc) {
    add(kDeformableKeywords[Deformable(def).index()], doc, [&](auto&& f) { ownFields(def, f); });
  };
  add("deformable", "what every deformable object has",
      [](auto&& f) { commonFields(static_cast<const DeformableDef&>(ParticlesDef{}), f); });
  own(TetSolidDef{}, "solid of tetrahedra, stable neo-Hookean");
  own(ClothDef{}, "sheet of triangles that resists stretch, shear and bending");
  own(CableDef{}, "line of vertices that resists stretch and bending, straight at rest; no twist");
  own(NetDef{}, "point masses joined by springs");
  own(ParticlesDef{}, "spheres that collide with bodies and with one another, and do not turn");
  for (const ElementKind& kind : elementKinds()) {
    DeformableInfo& info = infos.emplace_back(DeformableInfo{kind.name, kind.doc, {}});
    for (const ElementField& field : kind.fields)
      info.fields.push_back({field.key, field.unit, field.doc + wordOf(field)});
  }
  add("attachment",
      "mean of vertices held to a point of a body or of the world, or to another mean of vertices",
      [](auto&& f) {
        f("object", "1", "name or index of a deformable object", 0);
        f("body", "1", "name or index of a body; the world if it is not given", 0);
        f("other_object", "1", "of a seam: name or index of the other object", 0);
        attachmentFields(static_cast<const AttachmentDef&>(AttachmentDef{}), f);
      });
  return infos;
}

BuildInfo buildInfo() {
  BuildInfo info;
  info.version = build::kVersion;
  info.commit = build::kCommit;
#if defined(__clang__)
  info.compiler = std::string("clang ") + __clang_version__;
#elif defined(__GNUC__)
  info.compiler = std::string("gcc ") + __VERSION__;
#endif
  info.precision = "float; double in backend \"reference\"";
  info.features.emplace_back(std::string("cuda ") + cudaStatus());
  if (std::string(build::kFeatures).size() > 0) info.features.emplace_back(build::kFeatures);
  return info;
}

}  // namespace rubble
