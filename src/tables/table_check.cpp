#include "tables/table_check.h"

#include <cmath>

#include "stages/bodies/coloring.h"

namespace rubble::RUBBLE_CORE {

namespace {

class Checker {
 public:
  explicit Checker(const HostTables& tables) : s_(tables.view()), c_(*s_.counters), tables_(tables) {}

  std::string firstViolation(bool whole) {
    capacities(), bodies(), pairs();
    if (whole) manifolds();
    incidences(), trees(), vertices();
    return found_;
  }

 private:
  void expect(bool holds, const char* what, int element) {
    if (!holds && found_.empty()) found_ = std::string(what) + ", element " + std::to_string(element);
  }
  void expectFits(Per per, int count, const char* what) {
    expect(count <= tables_.capacity(per), what, count);
  }
  /// Offsets of `n` ranges.
  void expectOffsets(const Array<int>& offsets, int n, int most, const char* what) {
    expect(offsets[0] == 0, what, 0);
    for (int i = 0; i < n; ++i) expect(offsets[i] <= offsets[i + 1], what, i + 1);
    expect(offsets[n] <= most, what, n);
  }
  static bool isUnit(const Quat& q) { return std::abs(q.s * q.s + dot(q.v, q.v) - 1) < Real(1e-3); }

  void capacities() {
    expectFits(Per::Body, s_.bodies, "more bodies than slots");
    expectFits(Per::Pair, c_.pairs, "more pairs than slots");
    expectFits(Per::ActivePair, c_.activePairs, "more active pairs than slots");
    expectFits(Per::Manifold, c_.manifolds, "more manifolds than slots");
    expectFits(Per::Incidence, c_.incidences, "more incidences than slots");
    expectFits(Per::Vertex, s_.vertices, "more vertices than slots");
    expectFits(Per::PointPair, c_.pointPairs, "more pairs of vertices than slots");
    expectFits(Per::PointIncidence, c_.pointIncidences, "more incidences of vertices than slots");
  }

  void bodies() {
    for (int i = 0; i < s_.bodies; ++i) {
      expect(s_.worlds > 1 || s_.placeOf[s_.idOf[i]] == i, "placeOf is not the inverse of idOf", i);
      if (!isDynamic(s_, i)) continue;
      const Vec3d& p = s_.position[i];
      expect(std::isfinite(p.x + p.y + p.z), "position is not finite", i);
      expect(isUnit(s_.orientation[i]), "orientation is not of length 1", i);
      expect(isFinite(s_.velocity[i]) && isFinite(s_.angularVelocity[i]), "velocity is not finite", i);
      expect(s_.color[i] >= 0, "a dynamic body has no color", i);
    }
  }

  void pairs() {
    expectOffsets(s_.oldPairOffset, s_.bodies, tables_.capacity(Per::Pair), "oldPairOffset");
    const int pairs = s_.oldPairOffset[s_.bodies];
    expectOffsets(s_.oldActivePairOffset, pairs, tables_.capacity(Per::ActivePair), "oldActivePairOffset");
  }

  void manifolds() {
    for (int k = 0; k < s_.oldActivePairOffset[s_.oldPairOffset[s_.bodies]]; ++k) {
      const Manifold& m = s_.oldManifold[k];
      expect(m.count <= kLanes, "a manifold has too many points", k);
      if (m.count > 0)
        expect(std::abs(dot(m.normal, m.normal) - 1) < Real(1e-3), "a normal is not of length 1", k);
    }
  }

  /// Incidences are sorted, and name constraints of the body. Bodies that share a constraint have different
  /// colors.
  void incidences() {
    expectOffsets(s_.incidenceOffset, s_.bodies, tables_.capacity(Per::Incidence), "incidenceOffset");
    for (int i = 0; i < s_.bodies; ++i) {
      if (!isDynamic(s_, i)) continue;
      for (int k = s_.incidenceOffset[i]; k < s_.incidenceOffset[i + 1]; ++k) {
        const Incidence& e = s_.incidence[k];
        expect(k == s_.incidenceOffset[i] || s_.incidence[k - 1].code < e.code, "incidences are not sorted",
               k);
        if (e.other < 0 || c_.clashes > 0) continue;
        expect(e.other >= kVertexNode || e.other < s_.bodies, "an incidence names no body", k);
        const bool moves = e.other >= kVertexNode || isDynamic(s_, e.other);
        expect(!moves || colorOf(s_, e.other) != s_.color[i], "two bodies of a constraint share a color", k);
      }
    }
  }

  /// A node is eliminated before the nodes that it is coupled to.
  void trees() {
    for (int n = 0; n < s_.treeNodes; ++n) {
      const TreeNode& node = s_.treeNode[n];
      if (node.body < 0) continue;
      expect(s_.nodeOfBody[node.body] == n, "nodeOfBody is not the inverse of treeNode", n);
      for (const int parent : node.parent) {
        expect(parent < s_.treeNodes && parent != n, "a joint tree couples no node", n);
        if (parent >= 0) expect(s_.nodeLevel[parent] > s_.nodeLevel[n], "a parent is eliminated first", n);
      }
    }
  }

  void vertices() {
    for (int v = 0; v < s_.vertices; ++v) {
      const Vec3d& p = s_.vertexPosition[v];
      expect(std::isfinite(p.x + p.y + p.z) && isFinite(s_.vertexVelocity[v]), "a vertex is not finite", v);
    }
  }

  const SolverData& s_;
  const Counters& c_;
  const HostTables& tables_;
  std::string found_;
};

}  // namespace

std::string firstViolation(const HostTables& tables, bool whole) {
  return Checker(tables).firstViolation(whole);
}

}  // namespace rubble::RUBBLE_CORE
