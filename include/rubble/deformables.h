#pragma once
/// Definitions of deformable objects: solids, cloth, rods, nets and granular particles, in physical units.
#include <any>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <rubble/error.h>
#include <rubble/material.h>
#include <rubble/math.h>

namespace rubble {

/// An element of its own between vertices of an object, of a type whose header declares its fields
/// (docs/extending.md).
struct ElementDef {
  std::string type;           ///< keyword
  std::vector<int> vertices;  ///< as many as the type has corners
  std::any fields;            ///< a struct that the header declares; empty: its defaults
};

/// Fields that all deformable objects have.
struct DeformableDef {
  std::string name;            ///< optional
  std::vector<Vec3> vertices;  ///< rest shape, world [m]
  std::vector<Vec3> start;     ///< initial positions [m]; empty: the rest shape
  std::vector<int> fixed;      ///< indices of fixed vertices
  Vec3 velocity;               ///< [m/s]
  Vec3 angularVelocity;        ///< about the center of mass [rad/s]
  Material material;           ///< of the surface
  double gravityScale = 1;     ///< factor on gravity [1]
  bool collide = true;         ///< collide with bodies
  /// The surface (vertices, edges, triangles) collides with surfaces of other objects that have this flag.
  bool collideSurface = true;
  bool collideSelf = true;  ///< the surface collides with itself
  /// Vertices collide, as spheres of the contact radius, with vertices of other objects that have this flag.
  bool collideVertices = false;
  std::vector<ElementDef> elements;  ///< besides those that the kind of the object implies
  std::uint64_t userData = 0;        ///< as BodyDef::userData
};

/// A tetrahedral solid with the stable neo-Hookean energy.
struct TetSolidDef : DeformableDef {
  /// Without self-collision: the elastic volume resists it, and a folded surface must be free to unfold.
  TetSolidDef() { collideSelf = false; }
  /// Positive volume at rest: vertex 3 lies on the side that (1 - 0) x (2 - 0) points to.
  std::vector<std::array<int, 4>> tetrahedra;
  double youngsModulus = 1e5;  ///< [Pa]
  double poissonRatio = .4;    ///< [1], 0 to less than 0.5
  double density = 1000;       ///< [kg/m3]
  double viscosity = 0;        ///< viscosity of the strain rate [Pa s]
  /// Von Mises (Kirchhoff) yield stress [Pa]. Plastic strain beyond it is permanent.
  double yieldStress = kUnbreakable;
  /// Increase of the yield stress per unit of equivalent plastic strain [Pa].
  double hardening = 0;
  double contactRadius = 0;  ///< distance of the contact surface from the vertices [m]
};

/// Cloth: triangles that resist stretch, shear and bending.
struct ClothDef : DeformableDef {
  std::vector<std::array<int, 3>> triangles;
  double thickness = 1e-3;                 ///< [m]; contacts keep half of it as distance
  double youngsModulus = 1e6;              ///< [Pa]
  double poissonRatio = .3;                ///< [1], -1 to 1
  double density = 300;                    ///< [kg/m3]
  double viscosity = 0;                    ///< viscosity of the in-plane strain rate [Pa s]
  std::optional<double> bendingStiffness;  ///< [N m]; empty: E h^3 / (12 (1 - nu^2))
  bool restFolded = false;                 ///< rest angles are those of the rest shape; otherwise flat
  /// restFolded only: damping of the angle rate per meter of edge [N s/rad].
  double bendingDamping = 0;
  double tearStretch = kUnbreakable;  ///< stretch (length over rest length) at which a triangle tears
  /// Inside minus outside [Pa]. The sheet must be closed, its triangles counter-clockwise seen from outside.
  double pressure = 0;
};

/// A cable: a polyline that resists stretch and bending, straight at rest, without twist.
struct CableDef : DeformableDef {
  bool closed = false;               ///< closed ring
  double radius = .01;               ///< of the circular section, also for contacts [m]
  double youngsModulus = 1e7;        ///< [Pa]
  double density = 1000;             ///< [kg/m3]
  double viscosity = 0;              ///< viscosity of the stretch rate [Pa s]
  double breakForce = kUnbreakable;  ///< tension at which a segment breaks [N]
};

/// A net: point masses connected by springs.
struct NetDef : DeformableDef {
  /// Without surface collision by default: springs may cross. If enabled, only triangles collide.
  NetDef() { collideSurface = collideSelf = false; }
  struct Edge {
    int a, b;
    double stiffness;        ///< [N/m]
    double damping = 0;      ///< [N s/m]
    double restLength = -1;  ///< [m]; negative: distance in the rest shape
  };
  std::vector<double> masses;  ///< per vertex [kg]; a single value applies to all
  std::vector<Edge> edges;
  std::vector<std::array<int, 3>> triangles;  ///< surface for rendering and collision
  double contactRadius = 0;                   ///< [m]
  double breakForce = kUnbreakable;           ///< of each spring [N]
};

/// Granular particles: spheres that do not rotate. They collide with bodies, with each other and with objects
/// that set collideVertices.
struct ParticlesDef : DeformableDef {
  double radius = .01;    ///< [m]
  double density = 1500;  ///< [kg/m3]
};

using Deformable = std::variant<TetSolidDef, ClothDef, CableDef, NetDef, ParticlesDef>;

/// A constraint between a weighted mean of vertices and a point of a body, a point of the world, or another
/// such mean (a seam, vertex-vertex attachment).
struct AttachmentDef {
  std::string name;             ///< optional
  int object = 0;               ///< index into Scene::deformables
  std::vector<int> vertices;    ///< at most four, those of the other side included
  std::vector<double> weights;  ///< not negative, sum 1; empty: equal weights
  int body = kWorld;            ///< index into Scene::bodies, or kWorld
  std::optional<Vec3> anchor;   ///< in the body frame [m]; empty: at the initial vertex positions
  /// Vertex-vertex attachment: the object of the other side. -1: none.
  int otherObject = -1;
  std::vector<int> otherVertices;
  std::vector<double> otherWeights;
  double stiffness = kHard;          ///< [N/m], or hard
  double breakForce = kUnbreakable;  ///< [N]
};

/// The fields that all kinds share.
inline const DeformableDef& common(const Deformable& d) {
  return std::visit([](const auto& own) -> const DeformableDef& { return own; }, d);
}
inline DeformableDef& common(Deformable& d) {
  return std::visit([](auto& own) -> DeformableDef& { return own; }, d);
}

/// A box of cells with six tetrahedra each. `corner` is its lowest corner.
TetSolidDef tetBox(const Vec3& corner, const Vec3& size, const std::array<int, 3>& cells);
/// A ball of tetrahedra: a cube of `cells` cells per edge (at least 2), mapped to a ball. No tetrahedron has
/// all four corners on the surface.
TetSolidDef tetBall(const Vec3& center, double radius, int cells);
/// Cloth of cells with two triangles each: corner + s u + t v, s and t from 0 to 1. Vertex (i, j) has index i
/// + j (cellsU + 1).
ClothDef clothSheet(const Vec3& corner, const Vec3& u, const Vec3& v, int cellsU, int cellsV);
/// A straight cable.
CableDef straightCable(const Vec3& from, const Vec3& to, int segments);

/// Throws Error with the path of the first invalid field ("deformables[2].tetrahedra[17]").
void validate(const Deformable& deformable, const Path& path);

}  // namespace rubble
