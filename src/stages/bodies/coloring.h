#pragma once
/// Graph coloring: dynamic bodies and vertices that share a constraint or element have different colors, so
/// the nodes of a color are solved in parallel. Incremental Jones-Plassmann with hashed priorities. Colors
/// persist from step to step. Only nodes in conflict, or nodes that can take a lower color, choose a new one.
#include "stages/soft/vertex_graph.h"

namespace rubble::RUBBLE_CORE {

/// Priority of nodes of the graph: bodies by their ids, vertices by kVertexNode + their number in their
/// world.
RUBBLE_HD inline bool outranks(const SolverData& s, int a, int b) {
  const auto name = [&](int node) {
    return static_cast<std::uint32_t>(node >= kVertexNode ? kVertexNode + s.numberOfPoint(node - kVertexNode)
                                                          : s.idOf[node]);
  };
  const std::uint32_t na = name(a), nb = name(b), ha = hash32(na), hb = hash32(nb);
  return ha != hb ? ha > hb : na > nb;
}

RUBBLE_HD inline int colorOf(const SolverData& s, int node) {
  return node >= kVertexNode ? s.vertexColor[node - kVertexNode] : s.color[node];
}

/// Smallest color that no neighbor has; neighbors(visit) visits these. Workers that share the neighbors
/// combine their masks by join().
template <class Neighbors, class Join>
RUBBLE_HD int smallestFreeColor(const SolverData& s, Neighbors&& neighbors, Join&& join) {
  for (int base = 0;; base += 64) {
    std::uint64_t used = 0;
    neighbors([&](int node) {
      const int c = colorOf(s, node) - base;
      if (c >= 0 && c < 64) used |= std::uint64_t{1} << c;
    });
    used = join(used);
    if (~used == 0) continue;
    int c = 0;
    while (used >> c & 1) ++c;
    return base + c;
  }
}

template <class Neighbors> RUBBLE_HD int smallestFreeColor(const SolverData& s, Neighbors&& neighbors) {
  return smallestFreeColor(s, neighbors, [](std::uint64_t used) { return used; });
}

/// visit(node) for the neighbors of a node.
template <class Visit> RUBBLE_HD void visitNodeNeighbors(const SolverData& s, int node, Visit&& visit) {
  if (node >= kVertexNode) {
    visitNeighbors(s, node - kVertexNode, visit);
    return;
  }
  for (int k = s.incidenceOffset[node]; k < s.incidenceOffset[node + 1]; ++k)
    if (s.incidence[k].other >= 0) visit(s.incidence[k].other);
}

/// Colors of the neighbors of a node.
struct Surroundings {
  bool clashes = false;     ///< a neighbor of higher priority has the same color
  bool highest = true;      ///< all neighbors have lower colors
  std::uint64_t taken = 0;  ///< mask of the first 64 colors in use
  RUBBLE_HD void see(const SolverData& s, int node, int own, int other, int color) {
    clashes |= color == own && outranks(s, other, node);
    highest &= color < own;
    if (color >= 0 && color < 64) taken |= std::uint64_t{1} << color;
  }
};
template <class Neighbors>
RUBBLE_HD Surroundings lookAround(const SolverData& s, int node, Neighbors&& neighbors) {
  Surroundings around;
  const int own = colorOf(s, node);
  neighbors([&](int other) { around.see(s, node, own, other, colorOf(s, other)); });
  return around;
}
/// May a node take a lower color? Nodes that have only lower neighbors are not adjacent, so all of them may
/// do so at once. Fewer colors make shorter sweeps.
RUBBLE_HD inline bool goesDown(const Surroundings& around, int own, int& next) {
  if (!around.highest || own <= 0) return false;
  for (next = 0; next < 64 && (around.taken >> next & 1); ++next) {
  }
  return next < own && next < 64;
}

/// Does a body change its color to `next`? It must if a neighbor of higher priority has the same color. If
/// `mayGoDown`, it may also take a lower color.
RUBBLE_HD inline bool leavesColor(const SolverData& s, int i, bool mayGoDown, int& next) {
  const auto neighbors = [&](auto&& visit) { visitNodeNeighbors(s, i, visit); };
  const Surroundings around = lookAround(s, i, neighbors);
  if (around.clashes) next = smallestFreeColor(s, neighbors);
  return around.clashes || (mayGoDown && goesDown(around, s.color[i], next));
}
/// The same for a vertex.
RUBBLE_HD RUBBLE_OUT_OF_LINE inline bool vertexLeavesColor(const SolverData& s, int v, bool mayGoDown,
                                                           int& next) {
  const auto neighbors = [&](auto&& visit) { visitNeighbors(s, v, visit); };
  const Surroundings around = lookAround(s, kVertexNode + v, neighbors);
  if (around.clashes) next = smallestFreeColor(s, neighbors);
  return around.clashes || (mayGoDown && goesDown(around, s.vertexColor[v], next));
}

/// Lists the nodes that choose a color in this step, with their choice. Only these can conflict later,
/// because a choice avoids the colors of all neighbors that keep theirs.
struct FindClashes {
  static constexpr const char* kStage = "coloring";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (!isDynamic(s, i)) return;
    int next;
    if (leavesColor(s, i, true, next))
      note(s, i, next);
    else
      raiseColors(s, s.color[i]);
  }
  RUBBLE_HD static void note(const SolverData& s, int i, int next) {
    s.nextColor[i] = next;
    s.clashing[atomicCount(&s.counters->clashing, 1)] = i;
    atomicCount(&s.counters->clashes, 1);
  }
  RUBBLE_HD static void raiseColors(const SolverData& s, int color) {
    // most bodies find a larger value already
    if (atomicLoad(&s.counters->colors) <= color) atomicRaise(&s.counters->colors, color + 1);
  }
};

struct FindVertexClashes {
  static constexpr const char* kStage = "coloring";
  RUBBLE_HD void operator()(const SolverData& s, int v) const {
    if (!isDynamicVertex(s, v)) return;
    if (!vertexLeavesColor(s, v, true, s.vertexNextColor[v])) {
      FindClashes::raiseColors(s, s.vertexColor[v]);
      return;
    }
    s.clashing[atomicCount(&s.counters->clashing, 1)] = kVertexNode + v;
    atomicCount(&s.counters->clashes, 1);
  }
};

/// One round: nodes in conflict take their choice, and choose again if a neighbor has made the same one.
/// Reads `color` and writes `nextColor`, so the order within a round does not matter.
struct TakeColors {
  static constexpr const char* kStage = "coloring";
  RUBBLE_HD void operator()(const SolverData& s, int k) const {
    const int i = s.clashing[k], v = i - kVertexNode;
    if (v >= 0)
      s.vertexColor[v] = s.vertexNextColor[v];
    else
      s.color[i] = s.nextColor[i];
    FindClashes::raiseColors(s, colorOf(s, i));
  }
};
struct ProposeColors {
  static constexpr const char* kStage = "coloring";
  RUBBLE_HD void operator()(const SolverData& s, int k) const {
    const int i = s.clashing[k], v = i - kVertexNode;
    if (v >= 0 ? vertexLeavesColor(s, v, false, s.vertexNextColor[v])
               : leavesColor(s, i, false, s.nextColor[i]))
      atomicCount(&s.counters->clashes, 1);
  }
};

/// Does a body take part in the sweeps? Bodies of exactly solved trees do not.
RUBBLE_HD inline bool isSwept(const SolverData& s, int i) { return isDynamic(s, i) && !inExactTree(s, i); }

/// Number of bodies of each color.
struct CountColors {
  static constexpr const char* kStage = "coloring";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (isSwept(s, i)) atomicCount(&s.colorCount[s.color[i]], 1);
  }
};

/// Bodies by color. The order within a color does not affect results, because its bodies share no constraint.
struct FillColors {
  static constexpr const char* kStage = "coloring";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (!isSwept(s, i)) return;
    const int color = s.color[i];
    s.colorBody[s.colorOffset[color] + atomicCount(&s.colorCount[color], -1) - 1] = i;
  }
};

struct CountVertexColors {
  static constexpr const char* kStage = "coloring";
  RUBBLE_HD void operator()(const SolverData& s, int v) const {
    if (isDynamicVertex(s, v)) atomicCount(&s.vertexColorCount[s.vertexColor[v]], 1);
  }
};
/// The order within a color does not affect results.
struct FillVertexColors {
  static constexpr const char* kStage = "coloring";
  RUBBLE_HD void operator()(const SolverData& s, int v) const {
    if (!isDynamicVertex(s, v)) return;
    const int color = s.vertexColor[v];
    s.colorVertex[s.vertexColorOffset[color] + atomicCount(&s.vertexColorCount[color], -1) - 1] = v;
  }
};

}  // namespace rubble::RUBBLE_CORE
