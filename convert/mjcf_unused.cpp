/// What an import of MJCF does not use, and why.
#include "convert/mjcf_reader.h"
#include "convert/unused.h"

namespace rubble::convert {
namespace {

constexpr const char* kLook = "how it looks";
constexpr const char* kLight = "a further light; pictures have one sun";
constexpr const char* kSolver = "settings of the solver of MuJoCo";
constexpr const char* kSoft = "softness of constraints in MuJoCo; here they are hard";

/// Elements that are not converted, with everything in them.
const Reasons& elements() {
  static const Reasons all{
      {"visual", {Effect::None, kLook}},
      {"statistic", {Effect::None, "statistics for the display"}},
      {"size", {Effect::None, "sizes of memory"}},
      {"custom", {Effect::None, "data for users"}},
      {"camera", {Effect::None, kLook}},
      {"light", {Effect::None, kLight}},
      {"texture", {Effect::None, kLook}},
      {"material", {Effect::None, kLook}},
      {"skin", {Effect::None, kLook}},
      {"lengthrange", {Effect::None, "ranges of muscles"}},
      {"deformable", {Effect::Lost, "flexible objects of single bodies; author them as flexcomp"}},
      {"composite", {Effect::Lost, "composite objects other than cables"}},
      {"attach", {Effect::Lost, "models that are attached to this one"}},
      {"model", {Effect::Lost, "models that are attached to this one"}},
      {"extension", {Effect::Lost, "plugins"}},
      {"plugin", {Effect::Lost, "plugins"}},
      {"pair", {Effect::None, "contacts are disabled"}},
      {"flex", {Effect::Lost, "a constraint of flexible objects"}},
      {"flexstrain", {Effect::Lost, "a constraint of flexible objects"}},
      {"distance", {Effect::Lost, "a constraint of the distance of geoms"}},
  };
  return all;
}

/// Attributes that are not read: of one type of element, or of any.
const Reasons& attributes() {
  static const Reasons all{
      {"geom.priority",
       {Effect::Approximate, "which geom of a pair gives the friction; a pair takes the larger one"}},
      {"geom.solmix", {Effect::None, kSolver}},
      {"geom.margin", {Effect::Approximate, "contacts begin where surfaces touch"}},
      {"geom.gap", {Effect::Approximate, "contacts begin where surfaces touch"}},
      {"geom.adhesion", {Effect::Lost, "adhesive contacts"}},
      {"geom.surfacevel", {Effect::Lost, "velocity of the surface"}},
      {"geom.fluidshape", {Effect::None, "there is no medium"}},
      {"geom.fluidcoef", {Effect::None, "there is no medium"}},
      {"pair.friction", {Effect::Approximate, "a pair has the friction of its geoms"}},
      {"pair.condim", {Effect::Approximate, "a pair has the friction of its geoms"}},
      {"pair.margin", {Effect::Approximate, "contacts begin where surfaces touch"}},
      {"pair.gap", {Effect::Approximate, "contacts begin where surfaces touch"}},
      {"site.fromto", {Effect::None, kLook}},
      {"spatial.width", {Effect::None, kLook}},
      {"flexcomp.inertiabox", {Effect::None, "vertices are points"}},
      {"flexcomp.flatskin", {Effect::None, kLook}},
      {"flexcomp.texcoord", {Effect::None, kLook}},
      {"flexcomp.cellcount", {Effect::None, "each vertex moves by itself"}},
      {"contact.internal", {Effect::None, "elements that share a vertex do not collide"}},
      {"contact.activelayers", {Effect::None, "the whole surface collides"}},
      {"contact.passive", {Effect::Approximate, "contacts are those of other objects"}},
      {"contact.priority", {Effect::Approximate, "a pair takes the larger friction"}},
      {"contact.margin", {Effect::Approximate, "contacts begin where surfaces touch"}},
      {"contact.gap", {Effect::Approximate, "contacts begin where surfaces touch"}},
      {"contact.solmix", {Effect::None, kSolver}},
      {"elasticity.shear", {Effect::Approximate, "a cable does not resist twist"}},
      {"elasticity.section", {Effect::Approximate, "the section of a cable is round"}},
      {"elasticity.sectionsize", {Effect::Approximate, "the section of a cable is round"}},
      {"elasticity.yield", {Effect::Lost, "plastic deformation"}},
      {"edge.damping", {Effect::Approximate, "damping of edges"}},
      {"camera.target", {Effect::None, "the camera does not move"}},
      {"joint.margin", {Effect::None, "limits act where they are"}},
      {"joint.springyield", {Effect::Lost, "springs that yield"}},
      {"joint.actuatorgravcomp", {Effect::None, "compensation of gravity by actuators"}},
      {"body.sleep", {Effect::None, kSolver}},
      {"body.simple", {Effect::None, kSolver}},
      {"body.fuse", {Effect::None, "bodies without joints become part of their parents"}},
      {"equality.torquescale", {Effect::Approximate, kSoft}},
      {"equality.solref", {Effect::None, "a default that no constraint takes"}},
      {"equality.solimp", {Effect::None, "a default that no constraint takes"}},
      {"joint.solreflimit", {Effect::None, "of a joint without a limit"}},
      {"joint.solimplimit", {Effect::None, "of a joint without a limit"}},
      {"tendon.solreflimit", {Effect::None, "of a tendon without a limit"}},
      {"tendon.solimplimit", {Effect::None, "of a tendon without a limit"}},
      {"weld.torquescale", {Effect::Approximate, kSoft}},
      {"compiler.fitaabb", {Effect::Approximate, "primitives are fitted to meshes by their inertia"}},
      {"compiler.conflict", {Effect::None, "which of several models counts"}},
      {"option.o_friction", {Effect::Lost, "friction of all contacts"}},
      {"option.o_margin", {Effect::Lost, "margin of all contacts"}},
      {"option.magnetic", {Effect::None, "field of magnetometers"}},
      {"mesh.texcoord", {Effect::None, kLook}},
      {"mesh.normal", {Effect::None, kLook}},
      {"mesh.smoothnormal", {Effect::None, kLook}},
      {"mesh.maxhullvert", {Effect::None, "hulls have at most 64 corners"}},
      {"mesh.content_type", {Effect::None, "the ending of the name tells the format"}},
      {"hfield.content_type", {Effect::None, "the ending of the name tells the format"}},
      {"freejoint.align", {Effect::None, kSolver}},
      {"general.lengthrange", {Effect::None, "ranges of muscles"}},
  };
  return all;
}
const Reasons& anywhere() {
  static const Reasons all{
      {"rgba", {Effect::None, kLook}},
      {"material", {Effect::None, kLook}},
      {"castshadow", {Effect::None, kLook}},
      {"user", {Effect::None, "data for users"}},
      {"group", {Effect::None, "what is shown"}},
      {"class", {Effect::None, "no element has that class"}},
      {"name", {Effect::None, "nothing refers to it"}},
      {"solref", {Effect::Approximate, kSoft}},
      {"solimp", {Effect::Approximate, kSoft}},
      {"solreflimit", {Effect::Approximate, kSoft}},
      {"solimplimit", {Effect::Approximate, kSoft}},
      {"solreffriction", {Effect::Approximate, kSoft}},
      {"solimpfriction", {Effect::Approximate, kSoft}},
      {"actdim", {Effect::None, "number of activations"}},
      {"delay", {Effect::Lost, "delay of a control"}},
      {"noise", {Effect::None, "readings have no noise"}},
      {"interval", {Effect::None, "there is a reading for each step"}},
      {"nsample", {Effect::None, "history of a control"}},
      {"interp", {Effect::None, "history of a control"}},
  };
  return all;
}

}  // namespace

void noteUnusedMjcf(const Source& source, Report& report) {
  noteUnused(source, {elements(), attributes(), anywhere()}, report);
}

}  // namespace rubble::convert
