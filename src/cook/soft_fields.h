#pragma once
/// Authored fields of deformable objects and attachments. Scene files and listings are generated from them.
#include <rubble/deformables.h>

#include "math/field.h"

namespace rubble {

/// Keywords of the kinds, in the order of Deformable.
inline constexpr const char* kDeformableKeywords[] = {"tet_solid", "cloth", "cable", "net", "particles"};

/// Fields that all kinds share.
inline constexpr std::tuple kDeformableFields{
    field("name", "1", "optional", &DeformableDef::name),
    field("vertices", "m", "shape at rest, world", &DeformableDef::vertices),
    field("start", "m", "where the vertices start; at rest if it is not given", &DeformableDef::start),
    field("fixed", "1", "vertices that never move", &DeformableDef::fixed),
    field("velocity", "m/s", "at the beginning", &DeformableDef::velocity),
    field("angular_velocity", "rad/s", "about the center of mass", &DeformableDef::angularVelocity),
    field("material", "1", "of the surface; without rolling friction and belt", &DeformableDef::material),
    field("gravity_scale", "1", "factor on the scene's gravity", &DeformableDef::gravityScale),
    field("collide", "1", "with bodies", &DeformableDef::collide),
    field("collide_surface", "1", "vertices, edges and triangles, with those of other objects that say so",
          &DeformableDef::collideSurface),
    field("collide_self", "1", "vertices, edges and triangles, with one another",
          &DeformableDef::collideSelf),
    field("collide_vertices", "1", "with vertices of other objects that say so, as spheres",
          &DeformableDef::collideVertices)};

/// Fields of one kind.
template <class D> inline constexpr std::tuple<> kOwnFields;
template <>
inline constexpr std::tuple kOwnFields<TetSolidDef>{
    field("tetrahedra", "1", "four vertices each, of positive volume", &TetSolidDef::tetrahedra),
    field("youngs_modulus", "Pa", "E", &TetSolidDef::youngsModulus),
    field("poisson_ratio", "1", "nu, 0 to below .5", &TetSolidDef::poissonRatio),
    field("density", "kg/m3", "of the solid", &TetSolidDef::density),
    field("viscosity", "Pa s", "of the strain rate", &TetSolidDef::viscosity),
    field("yield_stress", "Pa", "von Mises stress at which it begins to flow", &TetSolidDef::yieldStress),
    field("hardening", "Pa", "of the yield stress, for each unit of plastic strain", &TetSolidDef::hardening),
    field("contact_radius", "m", "how far from a vertex its surface lies", &TetSolidDef::contactRadius)};
template <>
inline constexpr std::tuple kOwnFields<ClothDef>{
    field("triangles", "1", "three vertices each", &ClothDef::triangles),
    field("thickness", "m", "contacts keep half of it", &ClothDef::thickness),
    field("youngs_modulus", "Pa", "E", &ClothDef::youngsModulus),
    field("poisson_ratio", "1", "nu, -1 to below .5", &ClothDef::poissonRatio),
    field("density", "kg/m3", "of the sheet", &ClothDef::density),
    field("viscosity", "Pa s", "of the strain rate in the plane", &ClothDef::viscosity),
    field("bending_stiffness", "N m", "E h^3 / (12 (1 - nu^2)) if it is not given",
          &ClothDef::bendingStiffness),
    field("rest_folded", "1", "keep the angles of the mesh; else it wants to be flat", &ClothDef::restFolded),
    field("bending_damping", "N s/rad", "of the rate of an angle, for each metre of edge",
          &ClothDef::bendingDamping),
    field("tear_stretch", "1", "length over rest length at which a triangle tears", &ClothDef::tearStretch),
    field("pressure", "Pa", "inside over outside, of a closed sheet", &ClothDef::pressure)};
template <>
inline constexpr std::tuple kOwnFields<CableDef>{
    field("closed", "1", "a ring", &CableDef::closed),
    field("radius", "m", "of its circular section; also in contact", &CableDef::radius),
    field("youngs_modulus", "Pa", "E", &CableDef::youngsModulus),
    field("density", "kg/m3", "of the cable", &CableDef::density),
    field("viscosity", "Pa s", "of the stretch rate", &CableDef::viscosity),
    field("break_force", "N", "tension at which a segment breaks", &CableDef::breakForce)};
template <>
inline constexpr std::tuple kOwnFields<NetDef>{
    field("masses", "kg", "of each vertex; one number serves all", &NetDef::masses),
    field("edges", "N/m, N s/m, m",
          "springs: [vertex, vertex, stiffness, damping, rest length]; the last two may be left out",
          &NetDef::edges),
    field("triangles", "1", "only drawn", &NetDef::triangles),
    field("contact_radius", "m", "of a vertex", &NetDef::contactRadius),
    field("break_force", "N", "force at which a spring breaks", &NetDef::breakForce)};
template <>
inline constexpr std::tuple kOwnFields<ParticlesDef>{
    field("radius", "m", "of each sphere", &ParticlesDef::radius),
    field("density", "kg/m3", "of each sphere", &ParticlesDef::density)};

/// Fields of an attachment, without the objects and the body that it refers to.
inline constexpr std::tuple kAttachmentFields{
    field("name", "1", "optional", &AttachmentDef::name),
    field("vertices", "1", "of the object, up to four with those of the other side",
          &AttachmentDef::vertices),
    field("weights", "1", "of these vertices; equal ones if they are not given", &AttachmentDef::weights),
    field("anchor", "m", "in the frame of the body; where the vertices start if it is not given",
          &AttachmentDef::anchor),
    field("other_vertices", "1", "of a seam: of the other object", &AttachmentDef::otherVertices),
    field("other_weights", "1", "of these vertices", &AttachmentDef::otherWeights),
    field("stiffness", "N/m", "or \"hard\"", &AttachmentDef::stiffness),
    field("break_force", "N", "the attachment breaks when its force reaches this",
          &AttachmentDef::breakForce)};

/// Calls f(key, unit, doc, member) for each field of a list. `D` may be const.
template <class List, class D, class F> void visitFields(const List& list, D& d, F&& f) {
  forEachField(list, d, [&](const FieldInfo& info, auto& value) { f(info.key, info.unit, info.doc, value); });
}
template <class D, class F> void commonFields(D& d, F&& f) { visitFields(kDeformableFields, d, f); }
template <class D, class F> void ownFields(D& d, F&& f) {
  visitFields(kOwnFields<std::remove_const_t<D>>, d, f);
}
template <class D, class F> void attachmentFields(D& d, F&& f) { visitFields(kAttachmentFields, d, f); }

}  // namespace rubble
