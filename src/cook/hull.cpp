#include "cook/hull.h"

#include <rubble/error.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "cook/halving.h"
#include "platform/system.h"

#if defined(RUBBLE_HAS_QHULL)
extern "C" {
#include <libqhull_r/qhull_ra.h>
}
#endif

namespace rubble {

#if defined(RUBBLE_HAS_QHULL)

namespace {

/// Frees the memory of qhull on scope exit.
class Qhull {
 public:
  explicit Qhull(std::FILE* messages) { qh_zero(&qh_, messages); }
  ~Qhull() {
    qh_freeqhull(&qh_, !qh_ALL);
    int current = 0, total = 0;
    qh_memfreeshort(&qh_, &current, &total);
  }
  Qhull(const Qhull&) = delete;
  Qhull& operator=(const Qhull&) = delete;
  qhT* get() { return &qh_; }

 private:
  qhT qh_{};
};

/// Area vector of a polygon.
Vec3 areaOf(const std::vector<Vec3>& vertices, const std::vector<int>& face) {
  Vec3 sum;
  for (std::size_t k = 1; k + 1 < face.size(); ++k) {
    const auto at = [&](std::size_t i) { return vertices[static_cast<std::size_t>(face[i])]; };
    sum += cross(at(k) - at(0), at(k + 1) - at(0));
  }
  return sum * .5;
}

}  // namespace

bool hasHulls() { return true; }

Hull convexHull(const std::vector<Vec3>& points, const Path& path) {
  const std::string wanted = "at least four points that do not lie in one plane";
  if (points.size() < 4) throw Error(path, wanted, std::to_string(points.size()) + " points");
  // centered and scaled to size 1, so that tolerances are relative to the hull
  Vec3 low = points[0], high = points[0];
  for (const Vec3& p : points)
    for (int i = 0; i < 3; ++i) low[i] = std::min(low[i], p[i]), high[i] = std::max(high[i], p[i]);
  const Vec3 middle = (low + high) * .5;
  const double size = length(high - low);
  if (!(size > 0)) throw Error(path, wanted, "points in one place");
  std::vector<coordT> coordinates;
  coordinates.reserve(points.size() * 3);
  for (const Vec3& p : points)
    for (int i = 0; i < 3; ++i) coordinates.push_back((p[i] - middle[i]) / size);

  // the error reports failures, so qhull prints nothing
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> silence(
      std::fopen(platform::kNullFile, "w"), [](std::FILE* f) { return f ? std::fclose(f) : 0; });
  Qhull qhull(silence.get());
  qhT* qh = qhull.get();
  char options[] = "qhull Pp C-1e-7";
  const int failure = qh_new_qhull(qh, 3, static_cast<int>(points.size()), coordinates.data(), False, options,
                                   silence.get(), silence.get());
  if (failure == qh_ERRmem) throw std::bad_alloc();
  if (failure != 0) throw Error(path, wanted, "points that qhull makes no solid of");

  Hull hull;
  std::vector<int> placeOf(points.size(), -1), corners;
  vertexT *vertex, **vertexp;
  facetT* facet;
  FORALLvertices corners.push_back(qh_pointid(qh, vertex->point));
  std::sort(corners.begin(), corners.end());
  std::vector<Vec3> used;
  for (const int i : corners) used.push_back(points[static_cast<std::size_t>(i)]);
  for (const int k : nearOrder(used)) {
    placeOf[static_cast<std::size_t>(corners[static_cast<std::size_t>(k)])] = static_cast<int>(
        hull.vertices.size());
    hull.vertices.push_back(used[static_cast<std::size_t>(k)]);
  }
  FORALLfacets {
    std::vector<int> face;
    setT* const around = qh_facet3vertex(qh, facet);
    FOREACHvertex_(around) face.push_back(placeOf[static_cast<std::size_t>(qh_pointid(qh, vertex->point))]);
    qh_settempfree(qh, const_cast<setT**>(&around));
    Vec3 area = areaOf(hull.vertices, face);
    if (dot(area, Vec3{facet->normal[0], facet->normal[1], facet->normal[2]}) < 0) {
      std::reverse(face.begin(), face.end());
      area = -area;
    }
    if (!(length(area) > 1e-12 * size * size)) continue;
    hull.normals.push_back(normalize(area));
    hull.faces.push_back(std::move(face));
  }
  return hull;
}

#else

bool hasHulls() { return false; }
Hull convexHull(const std::vector<Vec3>&, const Path& path) {
  throw Error(path, "a build with qhull (package libqhull-dev)", "one without");
}

#endif

}  // namespace rubble
