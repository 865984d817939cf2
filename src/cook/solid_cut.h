#pragma once
/// Solids that are cut by planes, without a triangulation of the cuts. A cut closes with a fan of signed
/// triangles about one of its points: as a chain the surface stays closed, so volumes are exact.
#include <utility>
#include <vector>

#include <rubble/mesh.h>

namespace rubble {

/// Points with dot(normal, x) >= offset are in front.
struct Plane {
  Vec3 normal;        ///< unit
  double offset = 0;  ///< [m]

  double distance(const Vec3& x) const { return dot(normal, x) - offset; }
};

/// Convex polygons, one after the other.
class Polygons {
 public:
  std::vector<Vec3> corners;
  std::vector<int> ends;  ///< behind the last corner of each

  std::size_t count() const { return ends.size(); }
  /// Ends the polygon of the corners that were added; fewer than three are taken back.
  void close();
  template <class Visit> void forEach(const Visit& visit) const {
    int begin = 0;
    for (const int end : ends) {
      visit(corners.data() + begin, static_cast<std::size_t>(end - begin));
      begin = end;
    }
  }
  /// Sum of the cones from the origin [m3].
  double volume() const;
};

/// The closed surface that solids are cut from.
class CutSurface {
 public:
  explicit CutSurface(const TriangleMesh& surface) : surface_(&surface) {}

  /// Is the winding number at a point 1 or more?
  bool isInside(const Vec3& x) const;
  const TriangleMesh& mesh() const { return *surface_; }

 private:
  const TriangleMesh* surface_;
};

/// The part of a solid within a convex cell.
class CutSolid {
 public:
  /// The whole solid, in a box around it.
  explicit CutSolid(const CutSurface& whole);

  /// What lies in front of and behind a plane. Either may be empty.
  std::pair<CutSolid, CutSolid> cut(const Plane& plane) const;
  /// Cuts the cell alone; false if all of it lies in front.
  static bool cutCell(Polygons& cell, const Plane& plane);

  bool empty() const { return surface_.count() == 0 && caps_.count() == 0; }
  const Polygons& cell() const { return cell_; }
  const CutSurface& whole() const { return *whole_; }
  const std::vector<Plane>& planes() const { return planes_; }  ///< the solid is in front of each
  double volume() const { return surface_.volume() + caps_.volume(); }
  /// Points whose convex hull is that of the solid.
  std::vector<Vec3> hullPoints() const;

 private:
  CutSolid() = default;

  const CutSurface* whole_ = nullptr;
  Polygons surface_;  ///< of the original surface
  Polygons caps_;     ///< signed, on the planes
  Polygons cell_;
  std::vector<Plane> planes_;
};

}  // namespace rubble
