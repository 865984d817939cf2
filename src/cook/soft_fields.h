#pragma once
/// All authored fields of deformable objects: keyword in files, unit ("1" for none) and meaning. Scene files
/// and listings are generated from it.
#include <rubble/soft.h>

namespace rubble {

/// Keywords of the kinds, in the order of Deformable.
inline constexpr const char* kDeformableKeywords[] = {"soft", "cloth", "rod", "net", "particles"};

/// Calls f(key, unit, doc, member) for the fields that all kinds share. `D` may be const.
template <class D, class F> void commonFields(D& d, F&& f) {
  f("name", "1", "optional", d.name);
  f("vertices", "m", "shape at rest, world", d.vertices);
  f("start", "m", "where the vertices start; at rest if it is not given", d.start);
  f("fixed", "1", "vertices that never move", d.fixed);
  f("velocity", "m/s", "at the beginning", d.velocity);
  f("angular_velocity", "rad/s", "about the centre of mass", d.angularVelocity);
  f("material", "1", "of the surface; without rolling friction and belt", d.material);
  f("gravity_scale", "1", "factor on the scene's gravity", d.gravityScale);
  f("collide", "1", "with bodies", d.collide);
  f("collide_surface", "1", "vertices, edges and triangles, with those of other objects that say so",
    d.collideSurface);
  f("collide_self", "1", "vertices, edges and triangles, with one another", d.collideSelf);
  f("collide_vertices", "1", "with vertices of other objects that say so, as spheres", d.collideVertices);
}

template <class F, class D>
requires std::is_same_v<std::remove_const_t<D>, SoftDef>
void ownFields(D& d, F&& f) {
  f("tetrahedra", "1", "four vertices each, of positive volume", d.tetrahedra);
  f("youngs_modulus", "Pa", "E", d.youngsModulus);
  f("poisson_ratio", "1", "nu, 0 to below .5", d.poissonRatio);
  f("density", "kg/m3", "of the solid", d.density);
  f("viscosity", "Pa s", "of the strain rate", d.viscosity);
  f("yield_stress", "Pa", "von Mises stress at which it begins to flow", d.yieldStress);
  f("hardening", "Pa", "of the yield stress, for each unit of plastic strain", d.hardening);
  f("contact_radius", "m", "how far from a vertex its surface lies", d.contactRadius);
}
template <class F, class D>
requires std::is_same_v<std::remove_const_t<D>, ClothDef>
void ownFields(D& d, F&& f) {
  f("triangles", "1", "three vertices each", d.triangles);
  f("thickness", "m", "contacts keep half of it", d.thickness);
  f("youngs_modulus", "Pa", "E", d.youngsModulus);
  f("poisson_ratio", "1", "nu, -1 to below .5", d.poissonRatio);
  f("density", "kg/m3", "of the sheet", d.density);
  f("viscosity", "Pa s", "of the strain rate in the plane", d.viscosity);
  f("bending_stiffness", "N m", "E h^3 / (12 (1 - nu^2)) if it is not given", d.bendingStiffness);
  f("rest_folded", "1", "keep the angles of the mesh; else it wants to be flat", d.restFolded);
  f("bending_damping", "N s/rad", "of the rate of an angle, for each metre of edge", d.bendingDamping);
  f("tear_stretch", "1", "length over rest length at which a triangle tears", d.tearStretch);
  f("pressure", "Pa", "inside over outside, of a closed sheet", d.pressure);
}
template <class F, class D>
requires std::is_same_v<std::remove_const_t<D>, RodDef>
void ownFields(D& d, F&& f) {
  f("closed", "1", "a ring", d.closed);
  f("radius", "m", "of its circular section; also in contact", d.radius);
  f("youngs_modulus", "Pa", "E", d.youngsModulus);
  f("density", "kg/m3", "of the rod", d.density);
  f("viscosity", "Pa s", "of the stretch rate", d.viscosity);
  f("break_force", "N", "tension at which a segment breaks", d.breakForce);
}
template <class F, class D>
requires std::is_same_v<std::remove_const_t<D>, NetDef>
void ownFields(D& d, F&& f) {
  f("masses", "kg", "of each vertex; one number serves all", d.masses);
  f("edges", "N/m, N s/m, m",
    "springs: [vertex, vertex, stiffness, damping, rest length]; the last two may be left out", d.edges);
  f("triangles", "1", "only drawn", d.triangles);
  f("contact_radius", "m", "of a vertex", d.contactRadius);
  f("break_force", "N", "force at which a spring breaks", d.breakForce);
}
template <class F, class D>
requires std::is_same_v<std::remove_const_t<D>, ParticlesDef>
void ownFields(D& d, F&& f) {
  f("radius", "m", "of each sphere", d.radius);
  f("density", "kg/m3", "of each sphere", d.density);
}

/// The same for an attachment, without the objects and the body that it refers to.
template <class D, class F> void attachmentFields(D& d, F&& f) {
  f("name", "1", "optional", d.name);
  f("vertices", "1", "of the object, up to four with those of the other side", d.vertices);
  f("weights", "1", "of these vertices; equal ones if they are not given", d.weights);
  f("anchor", "m", "in the frame of the body; where the vertices start if it is not given", d.anchor);
  f("other_vertices", "1", "of a seam: of the other object", d.otherVertices);
  f("other_weights", "1", "of these vertices", d.otherWeights);
  f("stiffness", "N/m", "or \"hard\"", d.stiffness);
  f("break_force", "N", "the attachment breaks when its force reaches this", d.breakForce);
}

}  // namespace rubble
