#pragma once
/// Deformable objects as an author writes them: solids, cloth, rods, nets and granular particles, in physical
/// units only.
#include <array>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <rubble/material.h>
#include <rubble/math.h>

namespace rubble {

/// What all deformable objects have.
struct DeformableDef {
  std::string name;            ///< optional
  std::vector<Vec3> vertices;  ///< shape at rest, world [m]
  std::vector<Vec3> start;     ///< where the vertices start [m]; empty: at rest
  std::vector<int> fixed;      ///< vertices that never move
  Vec3 velocity;               ///< [m/s]
  Vec3 angularVelocity;        ///< about the centre of mass [rad/s]
  Material material;           ///< of the surface, in contact with bodies
  double gravityScale = 1;     ///< factor on the scene's gravity [1]
  bool collide = true;         ///< with bodies
  bool collideSurface = true;  ///< its vertices, edges and triangles collide with those of other objects that
                               ///< say so
  bool collideSelf = true;     ///< and with one another
  bool collideVertices = false;  ///< its vertices, as spheres of its contact radius, collide with those of
                                 ///< other objects that say so
};

/// A solid of tetrahedra: stable neo-Hookean.
struct SoftDef : DeformableDef {
  SoftDef() {
    collideSelf = false;
  }  ///< its volume resists; and a surface that is folded into itself must be free to come out again
  std::vector<std::array<int, 4>>
      tetrahedra;  ///< of positive volume at rest: vertex 3 on the side that (1 - 0) x (2 - 0) points to
  double youngsModulus = 1e5;         ///< [Pa]
  double poissonRatio = .4;           ///< [1], 0 to below .5
  double density = 1000;              ///< [kg/m3]
  double viscosity = 0;               ///< of the strain rate [Pa s]
  double yieldStress = kUnbreakable;  ///< von Mises (Kirchhoff) stress at which it begins to flow and keeps
                                      ///< what strains it flows by [Pa]
  double hardening = 0;      ///< of the yield stress, for each unit of equivalent plastic strain [Pa]
  double contactRadius = 0;  ///< how far from a vertex its surface lies [m]
};

/// A sheet of triangles that resists stretch, shear and bending.
struct ClothDef : DeformableDef {
  std::vector<std::array<int, 3>> triangles;
  double thickness = 1e-3;                 ///< [m]; contacts keep half of it
  double youngsModulus = 1e6;              ///< [Pa]
  double poissonRatio = .3;                ///< [1], -1 to 1
  double density = 300;                    ///< [kg/m3]
  double viscosity = 0;                    ///< of the strain rate in the plane [Pa s]
  std::optional<double> bendingStiffness;  ///< [N m]; none: E h^3 / (12 (1 - nu^2))
  bool restFolded = false;    ///< keep the angles that the mesh has at rest; else it wants to be flat
  double bendingDamping = 0;  ///< restFolded only: of the rate of an angle, for each metre of edge [N s/rad]
  double tearStretch = kUnbreakable;  ///< length over rest length at which a triangle tears
  double pressure = 0;  ///< inside over outside, of a closed sheet whose triangles are counter-clockwise from
                        ///< outside [Pa]
};

/// A line of vertices that resists stretch and bending, straight at rest; no twist.
struct RodDef : DeformableDef {
  bool closed = false;               ///< a ring
  double radius = .01;               ///< of its circular section [m]; also in contact
  double youngsModulus = 1e7;        ///< [Pa]
  double density = 1000;             ///< [kg/m3]
  double viscosity = 0;              ///< of the stretch rate [Pa s]
  double breakForce = kUnbreakable;  ///< tension at which a segment breaks [N]
};

/// Point masses joined by springs.
struct NetDef : DeformableDef {
  NetDef() {
    collideSurface = collideSelf = false;
  }  ///< springs may cross; of its surface only triangles collide
  struct Edge {
    int a, b;
    double stiffness;        ///< [N/m]
    double damping = 0;      ///< [N s/m]
    double restLength = -1;  ///< [m]; below 0: the distance of the vertices at rest
  };
  std::vector<double> masses;  ///< of each vertex [kg]; one number serves all
  std::vector<Edge> edges;
  std::vector<std::array<int, 3>> triangles;  ///< drawn, and its surface
  double contactRadius = 0;                   ///< [m]
  double breakForce = kUnbreakable;           ///< of a spring [N]
};

/// Spheres that collide with bodies, with one another and with other objects of collideVertices, and do not
/// turn.
struct ParticlesDef : DeformableDef {
  double radius = .01;    ///< [m]
  double density = 1500;  ///< [kg/m3]
};

using Deformable = std::variant<SoftDef, ClothDef, RodDef, NetDef, ParticlesDef>;

/// A weighted mean of vertices held to a point of a body or of the world, or to another mean of vertices (a
/// seam).
struct AttachmentDef {
  std::string name;             ///< optional
  int object = 0;               ///< index into Scene::deformables
  std::vector<int> vertices;    ///< up to four with those of the other side
  std::vector<double> weights;  ///< at least 0, which add up to 1; empty: equal ones
  int body = kWorld;            ///< index into Scene::bodies, or the world
  std::optional<Vec3> anchor;   ///< in the frame of the body [m]; none: where the vertices start
  int otherObject = -1;         ///< a seam: the other side is of this deformable object
  std::vector<int> otherVertices;
  std::vector<double> otherWeights;
  double stiffness = kHard;          ///< [N/m], or hard
  double breakForce = kUnbreakable;  ///< [N]
};

/// Common part of a deformable object of any kind.
inline const DeformableDef& common(const Deformable& d) {
  return std::visit([](const auto& own) -> const DeformableDef& { return own; }, d);
}
inline DeformableDef& common(Deformable& d) {
  return std::visit([](auto& own) -> DeformableDef& { return own; }, d);
}

/// A box of cells, each cut into six tetrahedra, with its lowest corner at `corner`.
SoftDef softBox(const Vec3& corner, const Vec3& size, const std::array<int, 3>& cells);
/// A ball of tetrahedra: a cube of `cells` each way, 2 at least, drawn to a ball. None of them has its four
/// corners on the surface.
SoftDef softBall(const Vec3& centre, double radius, int cells);
/// A sheet of cells, two triangles each: `corner` + s `u` + t `v`, s and t from 0 to 1. Vertex (i, j) is i +
/// j (cellsU + 1).
ClothDef clothSheet(const Vec3& corner, const Vec3& u, const Vec3& v, int cellsU, int cellsV);
/// A straight rod.
RodDef straightRod(const Vec3& from, const Vec3& to, int segments);

/// Throws Error with the path of the first thing that is wrong ("deformables[2].tetrahedra[17]").
void validate(const Deformable& deformable, const std::string& path);

}  // namespace rubble
