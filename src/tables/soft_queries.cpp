#include "tables/soft_queries.h"

#include <algorithm>

#include "tables/query_shapes.h"

namespace rubble::RUBBLE_CORE {

namespace {

/// Bounding box of the pieces of an object.
struct ObjectBox {
  Vec3d low, high;
  std::size_t begin, end;  ///< its pieces
};

class SoftSearch {
 public:
  SoftSearch(const EngineQueries& asked, const EngineSoftTargets& targets)
      : kind_(asked.kind), targets_(targets), shelf_(asked.shapes) {
    const std::vector<EngineSoftPiece>& pieces = targets.pieces;
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      if (k == 0 || pieces[k].object != pieces[k - 1].object) {
        const Vec3d first = targets.positions[static_cast<std::size_t>(pieces[k].v[0])];
        boxes_.push_back({first, first, k, k});
      }
      ObjectBox& box = boxes_.back();
      box.end = k + 1;
      const auto [low, high] = boxOf(pieces[k]);
      box.low = min(box.low, low), box.high = max(box.high, high);
    }
  }

  std::vector<EngineHit> hits(const EngineQuery& q) const {
    const QueryShapes own = shelf_.view();
    const ShapeData shape = shapeOf(own, q);
    const double reach = kind_ == QueryKind::Closest ? q.reach : 0;
    const Vec3d half = extent(shape, q.orientation) + Vec3d{reach, reach, reach};
    const Vec3d low = min(q.position, q.position + q.move) - half,
                high = max(q.position, q.position + q.move) + half;
    const auto near = [&](const Vec3d& from, const Vec3d& to) {
      return from.x <= high.x && from.y <= high.y && from.z <= high.z && to.x >= low.x && to.y >= low.y &&
             to.z >= low.z;
    };
    std::vector<EngineHit> out;
    for (const ObjectBox& box : boxes_) {
      if (!near(box.low, box.high)) continue;
      EngineHit best{-1, 0, {}, {}};
      for (std::size_t k = box.begin; k < box.end; ++k) {
        const EngineSoftPiece& piece = targets_.pieces[k];
        const auto [from, to] = boxOf(piece);
        if (!near(from, to)) continue;
        const EngineHit hit = meet(q, own, shape, piece);
        if (hit.body >= 0 && (best.body < 0 || hit.fraction < best.fraction)) best = hit;
      }
      if (best.body >= 0) out.push_back(best);
    }
    std::ranges::stable_sort(out, {}, &EngineHit::fraction);
    return out;
  }

 private:
  static Vec3d min(const Vec3d& a, const Vec3d& b) {
    return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
  }
  static Vec3d max(const Vec3d& a, const Vec3d& b) {
    return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
  }
  const Vec3d& corner(const EngineSoftPiece& piece, int k) const {
    return targets_.positions[static_cast<std::size_t>(piece.v[k])];
  }
  static int cornersOf(const EngineSoftPiece& piece) { return piece.v[1] < 0 ? 1 : piece.v[2] < 0 ? 2 : 3; }
  std::pair<Vec3d, Vec3d> boxOf(const EngineSoftPiece& piece) const {
    Vec3d low = corner(piece, 0), high = low;
    for (int k = 1; k < cornersOf(piece); ++k)
      low = min(low, corner(piece, k)), high = max(high, corner(piece, k));
    const Vec3d more{piece.radius, piece.radius, piece.radius};
    return {low - more, high + more};
  }
  /// A piece as a convex shape, relative to the origin of the query.
  Placed placedPiece(const EngineSoftPiece& piece, const Vec3d& origin) const {
    const int corners = cornersOf(piece);
    Convex shape{
        ShapeKind::Sphere, {0, 0, 0}, static_cast<Real>(piece.radius), nullptr, nullptr, nullptr, 0, 0, {}};
    if (corners == 1) return {shape, corner(piece, 0) - origin, {}};
    Vec3d center{};
    for (int k = 0; k < corners; ++k) center += corner(piece, k) / double(corners);
    Quatd q{};
    if (corners == 2) {
      const Vec3d half = (corner(piece, 1) - corner(piece, 0)) / 2;
      const double size = length(half);
      shape.kind = ShapeKind::Capsule;
      shape.half = {0, 0, static_cast<Real>(size)};
      // the shortest rotation from z
      const Vec3d d = size > 0 ? half / size : Vec3d{0, 0, 1};
      q = d.z > -0.999 ? normalize(Quatd{1 + d.z, {-d.y, d.x, 0}}) : Quatd{0, {1, 0, 0}};
    } else {
      shape.kind = ShapeKind::Triangle;
      for (int k = 0; k < 3; ++k) {
        shape.corner[k] = Vec3(corner(piece, k) - center);
        shape.half = Vec3{std::max(shape.half.x, std::abs(shape.corner[k].x)),
                          std::max(shape.half.y, std::abs(shape.corner[k].y)),
                          std::max(shape.half.z, std::abs(shape.corner[k].z))};
      }
    }
    return {shape, center - origin, q};
  }

  EngineHit meet(const EngineQuery& q, const QueryShapes& own, const ShapeData& shape,
                 const EngineSoftPiece& piece) const {
    EngineHit best{-1, 0, {}, {}};
    const auto take = [&](double fraction, const Vec3d& at, const Vec3d& n) {
      if (best.body < 0 || fraction < best.fraction)
        best = {piece.object, fraction, q.position + at, n, 0, piece.index};
    };
    const Placed target = placedPiece(piece, q.position);
    if (kind_ == QueryKind::Ray) {
      const RayImpact m = target.shape.kind == ShapeKind::Triangle
                              ? rays::triangle(-target.p, q.move, Vec3d(target.shape.corner[0]),
                                               Vec3d(target.shape.corner[1]), Vec3d(target.shape.corner[2]),
                                               true)
                              : castRay(target, {}, q.move);
      if (m.fraction <= 1) take(m.fraction, q.move * m.fraction, m.n == Vec3d{} ? normalize(-q.move) : m.n);
    } else if (kind_ == QueryKind::Closest) {
      const Separation at = separation({probes::point(), {}, {}}, target);
      const double distance = std::max(0.0, at.distance);
      if (distance <= q.reach) take(distance, at.distance > 0 ? at.onB : Vec3d{}, {});
    } else {
      const double gap = kCastGap * 2 * static_cast<double>(boundingRadius(shape));
      visitOwn(own.tables, shape, q.orientation, [&](const PlacedAny& part) {
        if (kind_ == QueryKind::Overlap) {
          if (separation(asConvex(part), target).distance <= 0) take(0, {}, {});
          return;
        }
        const TimeOfImpact m = timeOfImpact(target, probes::still(), asConvex(part), {q.move, {}}, gap);
        if (m.fraction <= 1) take(m.fraction, m.at.n == Vec3d{} ? Vec3d{} : m.at.onA, m.at.n);
      });
    }
    return best;
  }

  QueryKind kind_;
  const EngineSoftTargets& targets_;
  mutable QueryShelf shelf_;
  std::vector<ObjectBox> boxes_;
};

}  // namespace

std::vector<std::vector<EngineHit>> softHits(const EngineQueries& asked, const EngineSoftTargets& targets) {
  const SoftSearch search(asked, targets);
  std::vector<std::vector<EngineHit>> out(asked.queries.size());
  for (std::size_t i = 0; i < out.size(); ++i)
    if (asked.queries[i].deformables) out[i] = search.hits(asked.queries[i]);
  return out;
}

}  // namespace rubble::RUBBLE_CORE
