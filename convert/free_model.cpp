#include "convert/free_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <rubble/error.h>

#include "convert/geometry.h"
#include "convert/rotations.h"
#include "cook/convex_parts.h"

namespace rubble::convert {
namespace {

/// Relative difference of scales below which they are the same.
constexpr double kSameScale = 1e-5;
/// Parts of a mesh that is decomposed: volume beyond its own, and number.
constexpr double kConcavity = 0.05;
constexpr int kMostParts = 32;
/// Corners of a ring of a cone or cylinder that becomes a hull.
constexpr int kRing = 20;

class ShapeMaker {
 public:
  ShapeMaker(Link& link, const Affine& toLink, const Geom& like, bool isStatic, SolidSums& solid,
             Report& report)
      : link_(link), toLink_(toLink), like_(like), isStatic_(isStatic), solid_(solid), report_(report) {}

  bool add(const FreeShape& shape) {
    if (!toLink_.isFinite() || !(std::fabs(toLink_.determinant()) > 1e-24))
      return lose("its frame has a scale of 0, or numbers that are not finite");
    switch (shape.type) {
      case FreeShape::Type::Plane:
        if (!isStatic_) return lose("a plane is possible on static bodies only");
        geom(Shape::plane(), {{}, quatOfZ(unit(shape.axis))});
        return true;
      case FreeShape::Type::Mesh:
        return addMesh(shape);
      default:
        return addPrimitive(shape);
    }
  }

 private:
  bool lose(const std::string& why) {
    report_.note(Effect::Lost, like_.place, "collider" + inQuotes(like_.name), why);
    return false;
  }
  void approximate(const std::string& why) {
    report_.note(Effect::Approximate, like_.place, "collider" + inQuotes(like_.name), why);
  }
  static Vec3 unit(int axis) { return {axis == 0 ? 1. : 0., axis == 1 ? 1. : 0., axis == 2 ? 1. : 0.}; }

  /// A geom at a pose in the frame of the shape.
  void geom(Shape shape, const Pose& pose) {
    Geom out = like_;
    out.shape = std::move(shape);
    out.pose = tidied((toLink_ * Affine::of(pose)).rigid());
    link_.geoms.push_back(std::move(out));
  }
  void geomInLink(Shape shape, const Pose& pose = {}) {
    Geom out = like_;
    out.shape = std::move(shape);
    out.pose = pose;
    link_.geoms.push_back(std::move(out));
  }

  bool isOrthogonal() const {
    const Vec3 s = toLink_.scale();
    return std::fabs(dot(toLink_.x, toLink_.y)) < kSameScale * s.x * s.y &&
           std::fabs(dot(toLink_.y, toLink_.z)) < kSameScale * s.y * s.z &&
           std::fabs(dot(toLink_.z, toLink_.x)) < kSameScale * s.z * s.x;
  }

  bool addPrimitive(const FreeShape& shape) {
    const Vec3 s = toLink_.scale();
    const auto same = [&](double a, double b) { return std::fabs(a - b) <= kSameScale * std::max(a, b); };
    const int k = shape.axis, u = (k + 1) % 3, v = (k + 2) % 3;
    const double r = shape.radius, top = shape.topRadius < 0 ? r : shape.topRadius;
    const bool isBox = shape.type == FreeShape::Type::Box;
    const bool sizes = isBox ? std::min({shape.size.x, shape.size.y, shape.size.z}) > 0
                             : r >= 0 && top >= 0 && r + top > 0 && shape.height >= 0;
    if (!sizes || !(std::max({shape.size.x, shape.size.y, shape.size.z, r, top, shape.height}) < 1e9))
      return lose("its size is not above 0");
    const bool round = isOrthogonal() && same(s[u], s[v]) && same(r, top);
    const Pose alongAxis{{}, quatOfZ(unit(k))};
    Shape made;
    switch (shape.type) {
      case FreeShape::Type::Box:
        if (!isOrthogonal()) return hullOf(boxCorners(shape.size));
        made = Shape::box(mul(s, shape.size) / 2);
        break;
      case FreeShape::Type::Sphere:
        if (!round || !same(s[k], s[u]))
          return hullOf(spherePoints(r), "an ellipsoid is a hull of its points");
        made = Shape::sphere(r * s.x);
        break;
      case FreeShape::Type::Capsule:
        if (!round || !same(s[k], s[u]) || !(shape.height > 0)) {
          if (round && same(s[k], s[u])) {
            made = Shape::sphere(r * s.x);
            break;
          }
          return hullOf(capsulePoints(r, top, shape.height, k), "an uneven capsule is a hull of its points");
        }
        made = Shape::capsule(r * s[u], shape.height / 2 * s[k]);
        break;
      case FreeShape::Type::Cylinder:
        if (!(shape.height > 0)) return lose("its size is not above 0");
        if (!round)
          return hullOf(rings(r, top, shape.height, k), "an uneven cylinder is a hull of its points");
        made = Shape::cylinder(r * s[u], shape.height / 2 * s[k]);
        break;
      default:
        if (!(shape.height > 0) || !(r > 0)) return lose("its size is not above 0");
        if (!(isOrthogonal() && same(s[u], s[v])))
          return hullOf(rings(r, 0, shape.height, k), "an uneven cone is a hull of its points");
        made = Shape::cone(r * s[u], shape.height / 2 * s[k]);
        break;
    }
    const Pose inShape = isBox || shape.type == FreeShape::Type::Sphere ? Pose{} : alongAxis;
    const Pose pose = tidied((toLink_ * Affine::of(inShape)).rigid());
    solid_ += placed(sumsOf(massProperties(made, 1)), pose.p, pose.q, 1);
    geomInLink(std::move(made), pose);
    return true;
  }

  static std::vector<Vec3> boxCorners(const Vec3& size) {
    std::vector<Vec3> out;
    for (int i = 0; i < 8; ++i)
      out.push_back(mul(Vec3{i & 1 ? .5 : -.5, i & 2 ? .5 : -.5, i & 4 ? .5 : -.5}, size));
    return out;
  }
  static std::vector<Vec3> spherePoints(double r) {
    std::vector<Vec3> out = directions(static_cast<int>(kMostCorners) - 6);
    for (Vec3& x : out) x *= r;
    return out;
  }
  static std::vector<Vec3> rings(double r, double top, double height, int axis) {
    std::vector<Vec3> out;
    const auto ring = [&](double radius, double z) {
      for (int i = 0; i < (radius > 0 ? kRing : 1); ++i) {
        const double angle = 2 * std::numbers::pi * i / kRing;
        Vec3 p;
        p[axis] = z, p[(axis + 1) % 3] = radius * std::cos(angle),
        p[(axis + 2) % 3] = radius * std::sin(angle);
        out.push_back(p);
      }
    };
    ring(r, -height / 2), ring(top, height / 2);
    return out;
  }
  static std::vector<Vec3> capsulePoints(double r, double top, double height, int axis) {
    std::vector<Vec3> out;
    for (const Vec3& d : directions(24))
      for (const double end : {-1., 1.}) {
        Vec3 p = d * (end < 0 ? r : top);
        p[axis] += end * height / 2;
        out.push_back(p);
      }
    return out;
  }

  /// The hull of points in the frame of the shape.
  bool hullOf(std::vector<Vec3> points, const char* why = nullptr) {
    for (Vec3& p : points) p = toLink_ * p;
    const std::string where = like_.place.text() + ": " + like_.name;
    try {
      const TriangleMesh hull = convert::hullOf(points, where);
      bool reduced = false;
      Shape shape = Shape::hull(cornersOf(points, reduced, where));
      solid_ += massOf(hull, MeshMass::Exact, where);
      geomInLink(std::move(shape));
      if (why) approximate(why);
      if (reduced) approximate("at most 64 corners of a hull take part in contacts");
    } catch (const Error&) {
      return lose("it has no convex hull (it is flat, or this build has no qhull)");
    }
    return true;
  }

  bool addMesh(const FreeShape& shape) {
    TriangleMesh mesh = shape.mesh;
    if (mesh.vertices.empty() || mesh.triangles.empty()) return lose("a mesh without triangles");
    for (const Vec3& p : mesh.vertices)
      if (!(lengthSquared(toLink_ * p) < 1e30)) return lose("coordinates that are not below 1e15");
    if (shape.as == FreeShape::Mesh::Box || shape.as == FreeShape::Mesh::Sphere) return addBounds(shape);
    if (shape.as == FreeShape::Mesh::Triangles && isStatic_) {
      for (Vec3& p : mesh.vertices) p = toLink_ * p;
      if (toLink_.determinant() < 0)
        for (std::array<int, 3>& t : mesh.triangles) std::swap(t[1], t[2]);
      try {
        geomInLink(Shape::mesh(std::move(mesh.vertices), std::move(mesh.triangles), true));
      } catch (const Error& error) {
        return lose(error.what());
      }
      return true;
    }
    if (shape.as == FreeShape::Mesh::Parts && addParts(mesh)) return true;
    return hullOf(mesh.vertices,
                  shape.as == FreeShape::Mesh::Triangles ? "a mesh of a body that moves is its convex hull"
                  : shape.as == FreeShape::Mesh::Parts   ? "a mesh that is not closed is its hull"
                                                         : nullptr);
  }
  bool addParts(TriangleMesh mesh) {
    for (Vec3& p : mesh.vertices) p = toLink_ * p;
    if (toLink_.determinant() < 0)
      for (std::array<int, 3>& t : mesh.triangles) std::swap(t[1], t[2]);
    const std::string where = like_.place.text() + ": " + like_.name;
    try {
      bool reduced = false;
      std::vector<Shape> shapes;
      for (const ConvexPart& part : convexParts(mesh, kConcavity, kMostParts, where))
        shapes.push_back(Shape::hull(cornersOf(part.points, reduced, where)));
      for (Shape& each : shapes) geomInLink(std::move(each));
      solid_ += massOf(mesh, MeshMass::Exact, where);
    } catch (const Error&) {
      return false;
    }
    return true;
  }
  bool addBounds(const FreeShape& shape) {
    Vec3 low = shape.mesh.vertices[0], high = low;
    for (const Vec3& p : shape.mesh.vertices)
      for (int k = 0; k < 3; ++k) low[k] = std::min(low[k], p[k]), high[k] = std::max(high[k], p[k]);
    FreeShape bounds;
    bounds.size = high - low;
    bounds.type = shape.as == FreeShape::Mesh::Box ? FreeShape::Type::Box : FreeShape::Type::Sphere;
    bounds.radius = length(high - low) / 2;
    const Affine before = toLink_;
    toLink_ = toLink_ * Affine::of({(low + high) / 2, {}});
    const bool made = addPrimitive(bounds);
    toLink_ = before;
    return made;
  }

  Link& link_;
  Affine toLink_;
  const Geom& like_;
  bool isStatic_;
  SolidSums& solid_;
  Report& report_;
};

}  // namespace

Pose tidied(const Pose& pose) {
  constexpr double kRoundOff = 1e-14;
  Pose out = pose;
  for (int k = 0; k < 3; ++k) {
    if (std::fabs(out.p[k]) < kRoundOff) out.p[k] = 0;
    if (std::fabs(out.q.v[k]) < kRoundOff) out.q.v[k] = 0;
  }
  out.q = normalize(out.q);
  return out;
}

bool Affine::isFinite() const {
  double sum = 0;
  for (const Vec3& v : {x, y, z, t}) sum += std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z);
  return sum < 1e15;
}

Pose Affine::rigid() const {
  if (!(length(x) > 1e-12)) return {t, {}};
  const Vec3 a = normalize(x), across = y - a * dot(a, y);
  if (!(length(across) > 1e-12)) return {t, {}};
  const Vec3 b = normalize(across);
  return {t, quatOfAxes(a, b, cross(a, b))};
}

Affine Affine::of(const Pose& pose) {
  return {rotate(pose.q, {1, 0, 0}), rotate(pose.q, {0, 1, 0}), rotate(pose.q, {0, 0, 1}), pose.p};
}

bool addShape(Link& link, const FreeShape& shape, const Affine& toLink, const Geom& like, bool isStatic,
              SolidSums& solid, Report& report) {
  return ShapeMaker(link, toLink, like, isStatic, solid, report).add(shape);
}

JointDef jointOfAxes(const std::array<JointAxis, 6>& axes) {
  const auto locked = [&](std::size_t i) { return axes[i].min == axes[i].max; };
  const auto plain = [&](std::size_t i) {
    const JointAxis& a = axes[i];
    return a.min == -kFree && a.max == kFree && !(a.driveStiffness > 0) && !(a.driveDamping > 0) &&
           !(a.friction > 0) && !(a.armature > 0) && !(a.damping > 0) && a.motorForce == 0;
  };
  int free = 0;
  for (std::size_t i = 0; i < 6; ++i) free += locked(i) && axes[i].min == 0 ? 0 : 1;
  JointDef joint;
  const bool anchored = locked(0) && locked(1) && locked(2);
  if (free == 0) {
    joint.type = JointType::Fixed;
  } else if (anchored && plain(3) && plain(4) && plain(5)) {
    joint.type = JointType::Ball;
  } else if (free == 1 && !(locked(3) && axes[3].min == 0)) {
    joint.type = JointType::Hinge, joint.axes[0] = axes[3];
  } else if (free == 1 && !(locked(0) && axes[0].min == 0)) {
    joint.type = JointType::Slider, joint.axes[0] = axes[0];
  } else {
    joint.type = JointType::SixDof, joint.axes = axes;
  }
  return joint;
}

Quat frameOfAxis(int axis) {
  const auto unit = [](int k) {
    Vec3 v;
    v[k % 3] = 1;
    return v;
  };
  return quatOfAxes(unit(axis), unit(axis + 1), unit(axis + 2));
}

}  // namespace rubble::convert
