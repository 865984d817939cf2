#include <rubble/mesh.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "cook/distance_surface.h"
#include "cook/hull.h"
#include "cook/shape_traits.h"
#include "math/portable.h"

namespace rubble {

namespace {

constexpr double kTurn = 2 * std::numbers::pi;

class MeshBuilder {
 public:
  explicit MeshBuilder(int segments) : segments_(std::max(8, segments)) {}
  ShapeMesh mesh;

  int corner(const Vec3& point, const Vec3& normal) {
    mesh.points.push_back(point);
    mesh.normals.push_back(normal);
    return static_cast<int>(mesh.points.size()) - 1;
  }
  /// A planar convex face, counter-clockwise seen from outside.
  void face(const std::vector<Vec3>& corners) {
    Vec3 area;
    for (std::size_t k = 1; k + 1 < corners.size(); ++k)
      area += cross(corners[k] - corners[0], corners[k + 1] - corners[0]);
    const Vec3 n = normalize(area);
    const int first = static_cast<int>(mesh.points.size());
    for (const Vec3& x : corners) corner(x, n);
    for (int k = 1; k + 1 < static_cast<int>(corners.size()); ++k)
      mesh.triangles.push_back({first, first + k, first + k + 1});
  }
  void box(const Vec3& h) {
    for (int axis = 0; axis < 3; ++axis)
      for (const double side : {1.0, -1.0}) {
        Vec3 n, u, v;
        n[axis] = side * h[axis];
        u[(axis + 1) % 3] = h[(axis + 1) % 3];
        v[(axis + 2) % 3] = side * h[(axis + 2) % 3];
        face({n - u - v, n + u - v, n + u + v, n - u + v});
      }
  }
  /// A surface of revolution about z: radius, height and normal (radial, axial) of each ring, from the top
  /// down.
  struct Ring {
    double r, z, nr, nz;
  };
  void turned(const std::vector<Ring>& rings) {
    const int first = static_cast<int>(mesh.points.size());
    std::vector<std::array<double, 2>> around;  // cosine and sine
    for (int k = 0; k <= segments_; ++k) {
      const double angle = kTurn * k / segments_;
      around.push_back({portable::cos(angle), portable::sin(angle)});
    }
    for (const Ring& ring : rings)
      for (const auto& [c, s] : around)
        corner({ring.r * c, ring.r * s, ring.z}, {ring.nr * c, ring.nr * s, ring.nz});
    const int row = segments_ + 1;
    for (int i = 0; i + 1 < static_cast<int>(rings.size()); ++i)
      for (int k = 0; k < segments_; ++k) {
        const int a = first + i * row + k, b = a + row;
        const std::size_t at = static_cast<std::size_t>(i);
        if (rings[at].r > 0) mesh.triangles.push_back({a, b, a + 1});
        if (rings[at + 1].r > 0) mesh.triangles.push_back({b, b + 1, a + 1});
      }
  }
  /// A quarter circle of rings about (0, z), starting (top) or ending at the pole.
  void cap(std::vector<Ring>& rings, double r, double z, bool top) const {
    const int steps = segments_ / 4;
    for (int k = 0; k <= steps; ++k) {
      const double angle = kTurn / 4 * (top ? k : steps + k) / steps;
      const double s = k == (top ? 0 : steps) ? 0 : portable::sin(angle);
      rings.push_back({r * s, z + r * portable::cos(angle), s, portable::cos(angle)});
    }
  }
  void disc(double r, double z, double side) {
    std::vector<Vec3> corners;
    for (int k = 0; k < segments_; ++k) {
      const double angle = side * kTurn * k / segments_;
      corners.push_back({r * portable::cos(angle), r * portable::sin(angle), z});
    }
    face(corners);
  }
  /// Any rounded convex solid: faces of the hull of its support points in many directions.
  template <class Support> void rounded(double radius, const std::vector<Vec3>& normals, Support&& furthest) {
    std::vector<Vec3> points;
    const int count = segments_ * segments_ / 3;
    for (int k = 0; k < count; ++k) {
      // evenly distributed on the sphere (golden angle)
      const double z = 1 - (2 * k + 1.0) / count, s = std::sqrt(1 - z * z),
                   angle = kTurn * .61803398874989485 * k;
      const Vec3 d{s * portable::cos(angle), s * portable::sin(angle), z};
      for (const Vec3& x : furthest(d)) points.push_back(x + d * radius);
    }
    for (const Vec3& n : normals)
      for (const Vec3& x : furthest(n)) points.push_back(x + n * radius);
    polyhedron(convexHull(points, "shape"));
  }
  void polyhedron(const Hull& hull) {
    for (const std::vector<int>& f : hull.faces) {
      std::vector<Vec3> corners;
      for (const int v : f) corners.push_back(hull.vertices[static_cast<std::size_t>(v)]);
      face(corners);
    }
  }
  void add(const ShapeMesh& other, const Vec3& position, const Quat& q) {
    const int first = static_cast<int>(mesh.points.size());
    for (std::size_t i = 0; i < other.points.size(); ++i)
      corner(position + rotate(q, other.points[i]), rotate(q, other.normals[i]));
    for (const std::array<int, 3>& t : other.triangles)
      mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  int segments() const { return segments_; }

 private:
  int segments_;
};

/// All points that are extreme along d, within round-off.
std::vector<Vec3> furthestOf(const std::vector<Vec3>& points, const Vec3& d) {
  double most = -1e300;
  for (const Vec3& p : points) most = std::max(most, dot(p, d));
  std::vector<Vec3> out;
  for (const Vec3& p : points)
    if (dot(p, d) >= most - 1e-9 * (std::fabs(most) + 1e-9)) out.push_back(p);
  return out;
}

void addRounded(MeshBuilder& builder, const Shape& shape) {
  const double r = shape.rounding;
  if (shape.type == ShapeType::Cylinder) {
    std::vector<MeshBuilder::Ring> rings{{0, shape.halfLength, 0, 1}};
    const double inner = shape.radius - r, top = shape.halfLength - r;
    std::vector<MeshBuilder::Ring> upper, lower;
    builder.cap(upper, r, top, true);
    builder.cap(lower, r, -top, false);
    for (MeshBuilder::Ring ring : upper) ring.r += inner, rings.push_back(ring);
    for (MeshBuilder::Ring ring : lower) ring.r += inner, rings.push_back(ring);
    rings.push_back({0, -shape.halfLength, 0, -1});
    builder.turned(rings);
    return;
  }
  std::vector<Vec3> points, normals;
  if (shape.type == ShapeType::Box) {
    const Vec3 h = shape.halfExtents - Vec3{r, r, r};
    for (int k = 0; k < 8; ++k)
      points.push_back({(k & 1) ? h.x : -h.x, (k & 2) ? h.y : -h.y, (k & 4) ? h.z : -h.z});
    normals = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  } else {
    const Hull core = convexHull(shape.geometry->points, "shape.points");
    points = core.vertices, normals = core.normals;
  }
  builder.rounded(r, normals, [&](const Vec3& d) { return furthestOf(points, d); });
}

void addHeights(MeshBuilder& builder, const ShapeGeometry& g) {
  const int nx = g.counts[0], ny = g.counts[1];
  const auto height = [&](int i, int j) {
    return g.samples[static_cast<std::size_t>(std::clamp(j, 0, ny - 1) * nx + std::clamp(i, 0, nx - 1))];
  };
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const Vec3 along{(height(i + 1, j) - height(i - 1, j)) / (2 * g.spacing.x),
                       (height(i, j + 1) - height(i, j - 1)) / (2 * g.spacing.y), 0};
      builder.corner({i * g.spacing.x, j * g.spacing.y, height(i, j)},
                     normalize(Vec3{-along.x, -along.y, 1}));
    }
  for (int j = 0; j + 1 < ny; ++j)
    for (int i = 0; i + 1 < nx; ++i) {
      const int a = j * nx + i;
      builder.mesh.triangles.push_back({a, a + 1, a + nx + 1});
      builder.mesh.triangles.push_back({a, a + nx + 1, a + nx});
    }
}

/// The hull of support points of an added shape, along directions on a grid of latitudes and longitudes.
void addSupportPoints(MeshBuilder& builder, const ShapeTraits& traits, const Shape& shape) {
  const int around = builder.segments(), down = around / 2;
  std::vector<Vec3> points;
  for (int i = 0; i <= down; ++i)
    for (int k = 0; k < (i == 0 || i == down ? 1 : around); ++k) {
      const double a = std::numbers::pi * i / down, b = 2 * std::numbers::pi * k / around;
      points.push_back(traits.support(shape, {portable::sin(a) * portable::cos(b),
                                              portable::sin(a) * portable::sin(b), portable::cos(a)}));
    }
  builder.polyhedron(convexHull(points, "shape"));
}

}  // namespace

ShapeMesh shapeMesh(const Shape& shape, int segments) {
  MeshBuilder builder(segments);
  std::vector<MeshBuilder::Ring> rings;
  const double r = shape.radius, l = shape.halfLength;
  if (shape.rounding > 0 && hasField(traitsOf(shape.type).fields, "rounding")) {
    addRounded(builder, shape);
    return std::move(builder.mesh);
  }
  switch (shape.type) {
    case ShapeType::Sphere:
    case ShapeType::Capsule: {
      const double half = shape.type == ShapeType::Sphere ? 0 : l;
      builder.cap(rings, r, half, true);
      if (half == 0) rings.pop_back();
      builder.cap(rings, r, -half, false);
      builder.turned(rings);
      break;
    }
    case ShapeType::Box:
      builder.box(shape.halfExtents);
      break;
    case ShapeType::Plane:
      break;
    case ShapeType::Cylinder:
      builder.turned({{r, l, 1, 0}, {r, -l, 1, 0}});
      builder.disc(r, l, 1);
      builder.disc(r, -l, -1);
      break;
    case ShapeType::Cone: {
      const double size = portable::hypot(r, 2 * l);
      builder.turned({{0, l, 2 * l / size, r / size}, {r, -l, 2 * l / size, r / size}});
      builder.disc(r, -l, -1);
      break;
    }
    case ShapeType::Hull:
      builder.polyhedron(convexHull(shape.geometry->points, "shape.points"));
      break;
    case ShapeType::Compound:
      for (const ShapePartDef& part : shape.geometry->parts)
        builder.add(shapeMesh(part.shape, segments), part.position, normalize(part.orientation));
      break;
    case ShapeType::Mesh:
      for (const std::array<int, 3>& t : shape.geometry->triangles) {
        std::vector<Vec3> corners;
        for (const int v : t) corners.push_back(shape.geometry->points[static_cast<std::size_t>(v)]);
        builder.face(corners);
        if (!shape.geometry->twoSided) continue;
        std::reverse(corners.begin(), corners.end());
        builder.face(corners);
      }
      break;
    case ShapeType::HeightField:
      addHeights(builder, *shape.geometry);
      break;
    case ShapeType::DistanceField:
      return distanceSurface(*shape.geometry);
    default:
      addSupportPoints(builder, traitsOf(shape.type), shape);
  }
  return std::move(builder.mesh);
}

}  // namespace rubble
