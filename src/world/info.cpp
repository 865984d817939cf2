#include <rubble/info.h>

#include <build_info.h>

#include "cook/soft_fields.h"

namespace rubble {

namespace {

using Fields = std::vector<ForceField>;

Fields operator+(Fields a, const Fields& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

const Fields kAnchors = {{"anchor_a", "m", "point on body A, in its frame"},
                         {"anchor_b", "m", "point on body B, in its frame"}};
const Fields kFrames = {{"frame_a", "1", "axes of the joint on A, a unit quaternion"},
                        {"frame_b", "1", "axes of the joint on B"}};
const Fields kRest = {{"orientation_a_to_b", "1", "wanted orientation of A seen from B, a unit quaternion"}};
const Fields kStiffness = {{"stiffness", "N/m", "of the anchors, or \"hard\""},
                           {"damping", "N s/m", "beside a stiffness"},
                           {"damping_ratio", "1", "in its place: of critical"}};
const Fields kAngular = {{"angular_stiffness", "N m/rad", "of the orientation, or \"hard\""},
                         {"angular_damping", "N m s/rad", "beside an angular stiffness"},
                         {"angular_damping_ratio", "1", "in its place: of critical"},
                         {"max_torque", "N m", "the orientation is held with this torque at most"}};
const Fields kMaxForce = {{"max_force", "N", "the anchors are held with this force at most"}};
const Fields kBreak = {{"break_force", "N", "the joint breaks when its force reaches this"}};
const Fields kBreakTorque = {{"break_torque", "N m", "the joint breaks when its torque reaches this"}};
const Fields kLength = {{"length", "m", "as it is at the beginning if it is not given"},
                        {"stiffness", "N/m", "of the length, or \"hard\""},
                        {"damping", "N s/m", "beside a stiffness"},
                        {"damping_ratio", "1", "in its place: of critical"}};
const Fields kRatio = {{"ratio", "1", "between the motion of A and of B"}};

/// Fields of a joint axis.
Fields axis(const std::string& coordinate, const std::string& unit, const std::string& force) {
  return {{"axes[].min, max", unit, "limits of " + coordinate + "; equal ones lock it"},
          {"axes[].limit_stiffness, limit_damping", force + "/" + unit + ", " + force + " s/" + unit,
           "of the limits; hard if not given"},
          {"axes[].target_position, target_speed", unit + ", " + unit + "/s", "of the drive"},
          {"axes[].drive_stiffness, drive_damping", force + "/" + unit + ", " + force + " s/" + unit,
           "towards position and speed; may be \"hard\""},
          {"axes[].max_drive_force", force, "largest force of the drive"},
          {"axes[].friction", force, "resists any motion"}};
}

}  // namespace

std::vector<ForceInfo> forceInfos() {
  const Fields angle = axis("the angle", "rad", "N m"), travel = axis("the travel", "m", "N"),
               length = axis("the length", "m", "N");
  const Fields breaks = kBreak + kBreakTorque;
  return {
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
      {"ball", "ball joint: two anchors coincide", 3,
       kAnchors + kStiffness + kMaxForce + kBreak +
           Fields{{"friction", "N m", "torque that resists any turn"}}},
      {"fixed", "fixed joint: two anchors coincide and the relative orientation is kept", 6,
       kAnchors + kRest + kStiffness + kMaxForce + kAngular + breaks},
      {"hinge", "hinge: A turns about the x axis of the joint, counted over whole turns", 6,
       kAnchors + kFrames + angle + breaks},
      {"slider", "slider: A travels along the x axis of the joint and does not turn", 6,
       kAnchors + kFrames + kRest + travel + breaks},
      {"distance", "the anchors keep a distance", 1, kAnchors + kLength + length + kBreak},
      {"rope", "the anchors keep a largest distance", 1, kAnchors + kLength + length + kBreak},
      {"spring", "spring and damper between the anchors", 1, kAnchors + kLength + length + kBreak},
      {"angular_spring", "spring and damper towards a relative orientation; the anchors are free", 3,
       kRest + kAngular + kBreakTorque},
      {"swing_twist", "ball joint whose x axis swings in a cone and twists within limits", 11,
       kAnchors + kFrames +
           Fields{{"swing_y, swing_z", "rad", "half angles of the cone about y and z"},
                  {"friction", "N m", "torque that resists any turn"},
                  {"drive_orientation", "1", "wanted orientation of A's frame seen from B's"},
                  {"drive_stiffness, drive_damping", "N m/rad, N m s/rad", "towards it"},
                  {"max_drive_torque", "N m", "largest torque of that drive"}} +
           angle + breaks},
      {"universal", "two shafts (x axes) joined by a cross of A's y and B's z axis", 4,
       kAnchors + kFrames + breaks},
      {"six_dof", "travel along and turn about three axes, each free, limited, locked or driven", 6,
       kAnchors + kFrames + axis("a travel or an angle", "m, rad", "N, N m") + breaks},
      {"gear", "the turns of A and B about axes fixed in the world: theta_A + ratio theta_B is kept", 1,
       kFrames + kRatio + angle + kBreakTorque},
      {"rack",
       "turn of A about an axis fixed in the world, travel of B along a direction of the world: ratio theta "
       "- travel is kept",
       1, kAnchors + kFrames + kRatio + travel + kBreak},
      {"pulley",
       "a rope from A over two points of the world to B: the length of A's part + ratio of B's has a largest "
       "value",
       1,
       kAnchors + Fields{{"pulley_a, pulley_b", "m", "the points of the world"}} + kRatio + kLength + length +
           kBreak},
      {"grab", "soft drag of A's anchor to B's, with a largest force", 3, kAnchors + kStiffness + kMaxForce},
  };
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
  own(SoftDef{}, "solid of tetrahedra, stable neo-Hookean");
  own(ClothDef{}, "sheet of triangles that resists stretch, shear and bending");
  own(RodDef{}, "line of vertices that resists stretch and bending, straight at rest; no twist");
  own(NetDef{}, "point masses joined by springs");
  own(ParticlesDef{}, "spheres that collide with bodies and with one another, and do not turn");
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
