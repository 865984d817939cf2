#include "io/picture_raster.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

namespace rubble::io::draw {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// A convex polygon of at most six corners.
struct Polygon {
  std::array<Vec, 6> corners;
  int count = 0;
  void push(const Vec& corner) { corners[static_cast<std::size_t>(count++)] = corner; }
};

/// The part of a polygon with z > nearest.
Polygon clipNear(const Polygon& polygon, float nearest) {
  Polygon kept;
  for (int i = 0; i < polygon.count; ++i) {
    const Vec& a = polygon.corners[static_cast<std::size_t>(i)];
    const Vec& b = polygon.corners[static_cast<std::size_t>((i + 1) % polygon.count)];
    if (a.z > nearest) kept.push(a);
    if ((a.z > nearest) != (b.z > nearest)) kept.push(a + (b - a) * ((nearest - a.z) / (b.z - a.z)));
  }
  return kept;
}

/// First sample whose centre lies at or beyond `coordinate`, within [0, limit].
int firstSample(float coordinate, int limit) {
  return static_cast<int>(std::clamp(std::ceil(coordinate - .5f), 0.f, static_cast<float>(limit)));
}

struct Span {
  float left = kInfinity, right = -kInfinity;
};

struct Rectangle {
  int x0 = 0, x1 = 0, y0 = 0, y1 = 0;
};

class Rasterizer {
 public:
  Rasterizer(const View& view, Surfaces& out) : view_(view), out_(out), spans_(static_cast<std::size_t>(view.height)) {}

  void box(const ViewBody& body, std::uint32_t surface);
  void round(const ViewBody& body, std::uint32_t surface);
  void plane(const ViewBody& body, std::uint32_t surface);
  void triangles(const ViewBody& body, std::uint32_t surface);

 private:
  void face(const Polygon& polygon, const Vec& normal, std::uint32_t surface);
  void put(std::size_t index, float nearness, std::uint32_t surface) {
    if (nearness <= out_.nearness[index]) return;
    out_.nearness[index] = nearness;
    if (out_.surface.empty()) return;
    out_.surface[index] = surface;
    out_.detail[index] = detail_;
  }
  float sampleX(float planeX) const { return planeX * view_.scale + .5f * static_cast<float>(view_.width); }
  float sampleY(float planeY) const { return .5f * static_cast<float>(view_.height) - planeY * view_.scale; }
  void project(const Vec& corner, float& x, float& y) const {
    const float toPlane = view_.perspective ? 1 / corner.z : 1;
    x = sampleX(corner.x * toPlane);
    y = sampleY(corner.y * toPlane);
  }
  Rectangle boundsOfSphere(const Vec& center, float radius) const;
  float hitRound(const ViewBody& body, const Vec& origin, const Vec& direction) const;

  const View& view_;
  Surfaces& out_;
  std::vector<Span> spans_;
  std::uint32_t detail_ = 0;
};

void Rasterizer::face(const Polygon& whole, const Vec& normal, std::uint32_t surface) {
  const Polygon polygon = view_.perspective ? clipNear(whole, view_.nearest) : whole;
  if (polygon.count < 3) return;
  std::array<float, 6> xs, ys;
  float top = kInfinity, bottom = -kInfinity;
  for (std::size_t i = 0; i < static_cast<std::size_t>(polygon.count); ++i) {
    project(polygon.corners[i], xs[i], ys[i]);
    top = std::min(top, ys[i]);
    bottom = std::max(bottom, ys[i]);
  }
  const int y0 = firstSample(top, view_.height), y1 = firstSample(bottom, view_.height);
  for (int y = y0; y < y1; ++y) spans_[static_cast<std::size_t>(y)] = {};
  for (std::size_t i = 0; i < static_cast<std::size_t>(polygon.count); ++i) {
    const std::size_t j = (i + 1) % static_cast<std::size_t>(polygon.count);
    const std::size_t a = ys[i] < ys[j] ? i : j, b = ys[i] < ys[j] ? j : i;
    const int begin = firstSample(ys[a], view_.height), end = firstSample(ys[b], view_.height);
    if (begin >= end) continue;
    const float slope = (xs[b] - xs[a]) / (ys[b] - ys[a]);
    for (int y = begin; y < end; ++y) {
      const float x = xs[a] + slope * (static_cast<float>(y) + .5f - ys[a]);
      Span& span = spans_[static_cast<std::size_t>(y)];
      span.left = std::min(span.left, x);
      span.right = std::max(span.right, x);
    }
  }
  // Nearness is linear over the window: 1/z = n.(X, Y, 1) / n.p in perspective, -z = (n.(X, Y, 0) - n.p) / n.z else.
  const float offset = dot(normal, whole.corners[0]);
  const float divisor = view_.perspective ? offset : normal.z;
  const float dx = normal.x / divisor, dy = normal.y / divisor;
  const float constant = view_.perspective ? normal.z / divisor : -offset / divisor;
  const float stepX = dx / view_.scale;
  for (int y = y0; y < y1; ++y) {
    const Span& span = spans_[static_cast<std::size_t>(y)];
    const int x0 = firstSample(span.left, view_.width), x1 = firstSample(span.right, view_.width);
    const float atRow = constant + dy * view_.planeY(y) + dx * view_.planeX(0);
    const std::size_t row = out_.at(0, y);
    for (int x = x0; x < x1; ++x) put(row + static_cast<std::size_t>(x), atRow + stepX * static_cast<float>(x), surface);
  }
}

void Rasterizer::box(const ViewBody& body, std::uint32_t surface) {
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      const Vec normal = side == 0 ? body.axes[axis] : -body.axes[axis];
      const Vec middle = body.center + normal * body.half[axis];
      const bool towardsEye = view_.perspective ? dot(normal, middle) < 0 : normal.z < 0;
      if (!towardsEye) continue;
      const Vec u = body.axes[(axis + 1) % 3] * body.half[(axis + 1) % 3];
      const Vec v = body.axes[(axis + 2) % 3] * body.half[(axis + 2) % 3];
      Polygon polygon;
      for (const Vec& corner : {middle - u - v, middle + u - v, middle + u + v, middle - u + v}) polygon.push(corner);
      face(polygon, normal, surface + static_cast<std::uint32_t>(axis * 2 + side));
    }
  }
}

Rectangle Rasterizer::boundsOfSphere(const Vec& center, float radius) const {
  const Rectangle everything{0, view_.width, 0, view_.height};
  float x0 = center.x - radius, x1 = center.x + radius, y0 = center.y - radius, y1 = center.y + radius;
  if (view_.perspective) {
    if (center.z + radius < view_.nearest) return {};
    if (center.z - radius < view_.nearest) return everything;
    // The tangents of the two directions that graze the sphere; both lie ahead, since the whole sphere does.
    const auto tangents = [&](float across, float& low, float& high) {
      const float angle = std::atan2(across, center.z);
      const float spread = std::asin(radius / std::hypot(across, center.z));
      low = std::tan(angle - spread);
      high = std::tan(angle + spread);
    };
    tangents(center.x, x0, x1);
    tangents(center.y, y0, y1);
  }
  return {firstSample(sampleX(x0), view_.width), firstSample(sampleX(x1) + 1, view_.width), firstSample(sampleY(y1), view_.height),
          firstSample(sampleY(y0) + 1, view_.height)};
}

/// Ray parameter of the first hit with a sphere, or infinity.
float hitSphere(const Vec& center, float radius, const Vec& origin, const Vec& direction) {
  const Vec toCenter = center - origin;
  const float a = dot(direction, direction), b = dot(direction, toCenter);
  const Vec across = toCenter - direction * (b / a);
  const float h2 = radius * radius - dot(across, across);
  return h2 < 0 ? kInfinity : (b - std::sqrt(a * h2)) / a;
}

float Rasterizer::hitRound(const ViewBody& body, const Vec& origin, const Vec& direction) const {
  if (body.type == ShapeType::Sphere) return hitSphere(body.center, body.radius, origin, direction);
  const Vec& axis = body.axes[2];
  const Vec tip = axis * body.halfLength;
  const Vec out = origin - body.center;
  const Vec d = direction - axis * dot(direction, axis);
  const Vec o = out - axis * dot(out, axis);
  const float a = dot(d, d), b = dot(d, o);
  const float alongRay = 1e-6f * dot(direction, direction);
  if (a > alongRay) {
    const Vec across = o - d * (b / a);
    const float h2 = body.radius * body.radius - dot(across, across);
    if (h2 < 0) return kInfinity;
    const float t = (-b - std::sqrt(a * h2)) / a;
    const float height = dot(out + direction * t, axis);
    if (std::fabs(height) <= body.halfLength) return t;
    return hitSphere(height > 0 ? body.center + tip : body.center - tip, body.radius, origin, direction);
  }
  return std::min(hitSphere(body.center + tip, body.radius, origin, direction),
                  hitSphere(body.center - tip, body.radius, origin, direction));
}

void Rasterizer::round(const ViewBody& body, std::uint32_t surface) {
  const Vec tip = body.type == ShapeType::Capsule ? body.axes[2] * body.halfLength : Vec{};
  const Rectangle a = boundsOfSphere(body.center + tip, body.radius), b = boundsOfSphere(body.center - tip, body.radius);
  for (int y = std::min(a.y0, b.y0); y < std::max(a.y1, b.y1); ++y) {
    for (int x = std::min(a.x0, b.x0); x < std::max(a.x1, b.x1); ++x) {
      const float px = view_.planeX(x), py = view_.planeY(y);
      const Vec origin = view_.perspective ? Vec{} : Vec{px, py, 0};
      const Vec direction = view_.perspective ? Vec{px, py, 1} : Vec{0, 0, 1};
      const float z = hitRound(body, origin, direction);
      if (z == kInfinity || (view_.perspective && z < view_.nearest)) continue;
      put(out_.at(x, y), view_.perspective ? 1 / z : -z, surface);
    }
  }
}

void Rasterizer::plane(const ViewBody& body, std::uint32_t surface) {
  const Vec& normal = body.axes[2];
  const float offset = dot(normal, body.center);
  const bool eyeIsAbove = offset < 0;
  if (!view_.perspective || !eyeIsAbove) return;
  for (int y = 0; y < view_.height; ++y) {
    const float atRow = (normal.z + normal.y * view_.planeY(y)) / offset;
    for (int x = 0; x < view_.width; ++x) put(out_.at(x, y), atRow + normal.x * view_.planeX(x) / offset, surface);
  }
}

void Rasterizer::triangles(const ViewBody& body, std::uint32_t surface) {
  const ShapeMesh& mesh = *body.mesh;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    Vec corner[3];
    for (std::size_t k = 0; k < 3; ++k) corner[k] = body.placed(mesh.points[static_cast<std::size_t>(mesh.triangles[t][k])]);
    // view space is left-handed
    const Vec normal = -cross(corner[1] - corner[0], corner[2] - corner[0]);
    const bool towardsEye = view_.perspective ? dot(normal, corner[0]) < 0 : normal.z < 0;
    if (!towardsEye) continue;
    Polygon polygon;
    for (const Vec& c : corner) polygon.push(c);
    detail_ = static_cast<std::uint32_t>(t);
    face(polygon, normalize(normal), surface);
  }
  detail_ = 0;
}

/// The normals of the corners, mixed as the point lies between them.
Vec smoothNormal(const ViewBody& body, std::uint32_t triangle, const Vec& point) {
  const ShapeMesh& mesh = *body.mesh;
  const std::array<int, 3>& t = mesh.triangles[triangle];
  Vec corner[3], normal[3];
  for (std::size_t k = 0; k < 3; ++k) {
    corner[k] = body.placed(mesh.points[static_cast<std::size_t>(t[k])]);
    normal[k] = body.turned(mesh.normals[static_cast<std::size_t>(t[k])]);
  }
  const Vec flat = cross(corner[1] - corner[0], corner[2] - corner[0]);
  Vec sum;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec &a = corner[(k + 1) % 3], &b = corner[(k + 2) % 3];
    sum += normal[k] * std::max(0.f, dot(flat, cross(b - a, point - a)));
  }
  return normalize(sum, normalize(-flat));
}

}  // namespace

Vec ViewBody::turned(const Vec3& direction) const {
  const Vec d(direction);
  return axes[0] * d.x + axes[1] * d.y + axes[2] * d.z;
}
Vec ViewBody::placed(const Vec3& point) const { return center + turned(point); }

Vec View::toView(const Vec3& world) const { return turnToView(world - eye); }

Vec View::turnToView(const Vec3& world) const { return Vec(Vec3{dot(right, world), dot(up, world), dot(forward, world)}); }

std::vector<ViewBody> toView(const View& view, std::span<const PictureBody> bodies) {
  std::vector<ViewBody> out;
  out.reserve(bodies.size());
  // bodies of one shape share its triangles
  using Key = std::tuple<ShapeType, double, double, double, double, double, double, const ShapeGeometry*>;
  std::map<Key, std::shared_ptr<const ShapeMesh>> meshes;
  const auto meshOf = [&](const Shape& s) -> std::shared_ptr<const ShapeMesh> {
    const bool plain = s.type == ShapeType::Sphere || s.type == ShapeType::Capsule || s.type == ShapeType::Plane;
    if (plain || (s.type == ShapeType::Box && s.rounding == 0)) return nullptr;
    const Key key{s.type, s.halfExtents.x, s.halfExtents.y, s.halfExtents.z, s.radius, s.halfLength, s.rounding, s.geometry.get()};
    std::shared_ptr<const ShapeMesh>& mesh = meshes[key];
    if (!mesh) mesh = std::make_shared<const ShapeMesh>(shapeMesh(s));
    return mesh;
  };
  for (const PictureBody& body : bodies) {
    const Mat3 axes = rotationMatrix(body.orientation);
    out.push_back({body.shape.type,
                   view.toView(body.position),
                   {view.turnToView(axes.c0), view.turnToView(axes.c1), view.turnToView(axes.c2)},
                   Vec(body.shape.halfExtents),
                   static_cast<float>(body.shape.radius),
                   static_cast<float>(body.shape.halfLength),
                   meshOf(body.shape)});
  }
  return out;
}

Surfaces::Surfaces(const View& view, bool withSurface) : width(view.width), height(view.height) {
  const std::size_t count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  nearness.assign(count, view.perspective ? 0 : -kInfinity);
  if (withSurface) surface.assign(count, kNothing), detail.assign(count, 0);
}

void rasterize(const View& view, std::span<const ViewBody> bodies, Surfaces& out) {
  Rasterizer rasterizer(view, out);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const std::uint32_t surface = static_cast<std::uint32_t>(i) * 8;
    if (bodies[i].mesh) {
      rasterizer.triangles(bodies[i], surface);
      continue;
    }
    switch (bodies[i].type) {
      case ShapeType::Box:
        rasterizer.box(bodies[i], surface);
        break;
      case ShapeType::Sphere:
      case ShapeType::Capsule:
        rasterizer.round(bodies[i], surface);
        break;
      case ShapeType::Plane:
        rasterizer.plane(bodies[i], surface);
        break;
      default: break;
    }
  }
}

Vec normalAt(const ViewBody& body, std::uint32_t face, const Vec& point, std::uint32_t detail) {
  if (body.mesh) return smoothNormal(body, detail, point);
  switch (body.type) {
    case ShapeType::Box:
      return face % 2 == 0 ? body.axes[face / 2] : -body.axes[face / 2];
    case ShapeType::Plane:
      return body.axes[2];
    case ShapeType::Sphere:
      return normalize(point - body.center);
    default:
      break;
  }
  const Vec out = point - body.center;
  return normalize(out - body.axes[2] * std::clamp(dot(out, body.axes[2]), -body.halfLength, body.halfLength));
}

}  // namespace rubble::io::draw
