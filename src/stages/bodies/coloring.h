#pragma once
/// Colours: dynamic bodies and vertices that share a row block or element have different ones, so that a
/// colour can be solved in parallel. Incremental Jones-Plassmann with hashed priorities: colours are kept
/// from step to step, and only nodes that clash, or can go down to a lower one, choose anew.
#include "stages/soft/vertex_graph.h"

namespace rubble::RUBBLE_CORE {

/// Of two nodes of the graph: bodies, by their ids, or vertices (kVertexNode + index).
RUBBLE_HD inline bool outranks(const SolverData& s, int a, int b) {
  const auto name = [&](int node) {
    return static_cast<std::uint32_t>(node >= kVertexNode ? node : s.idOf[node]);
  };
  const std::uint32_t na = name(a), nb = name(b), ha = hash32(na), hb = hash32(nb);
  return ha != hb ? ha > hb : na > nb;
}

RUBBLE_HD inline int colorOf(const SolverData& s, int node) {
  return node >= kVertexNode ? s.vertexColor[node - kVertexNode] : s.color[node];
}

/// Smallest colour that none of the nodes has which neighbors(visit) visits. Several that share them out join
/// what each has found.
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

/// visit(node) for the neighbours of a node.
template <class Visit> RUBBLE_HD void visitNodeNeighbors(const SolverData& s, int node, Visit&& visit) {
  if (node >= kVertexNode) {
    visitNeighbors(s, node - kVertexNode, visit);
    return;
  }
  for (int k = s.incidenceOffset[node]; k < s.incidenceOffset[node + 1]; ++k)
    if (s.incidence[k].other >= 0) visit(s.incidence[k].other);
}

/// What a node sees of the colours around it.
struct Surroundings {
  bool clashes = false;     ///< a neighbour of higher rank has the same
  bool highest = true;      ///< all have lower ones
  std::uint64_t taken = 0;  ///< of the first 64
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
/// May a node go down to a lower colour? Those that see only lower ones are no neighbours of one another, and
/// can all do so at a time. Few colours make short sweeps.
RUBBLE_HD inline bool goesDown(const Surroundings& around, int own, int& next) {
  if (!around.highest || own <= 0) return false;
  for (next = 0; next < 64 && (around.taken >> next & 1); ++next) {
  }
  return next < own && next < 64;
}

/// Does a body share a colour with a neighbour of higher rank? Then it is to take `next`; or, where it may,
/// one that is lower.
RUBBLE_HD inline bool leavesColor(const SolverData& s, int i, bool mayGoDown, int& next) {
  const auto neighbors = [&](auto&& visit) { visitNodeNeighbors(s, i, visit); };
  const Surroundings around = lookAround(s, i, neighbors);
  if (around.clashes) next = smallestFreeColor(s, neighbors);
  return around.clashes || (mayGoDown && goesDown(around, s.color[i], next));
}
/// The same for a vertex.
RUBBLE_HD RUBBLE_APART inline bool vertexLeavesColor(const SolverData& s, int v, bool mayGoDown, int& next) {
  const auto neighbors = [&](auto&& visit) { visitNeighbors(s, v, visit); };
  const Surroundings around = lookAround(s, kVertexNode + v, neighbors);
  if (around.clashes) next = smallestFreeColor(s, neighbors);
  return around.clashes || (mayGoDown && goesDown(around, s.vertexColor[v], next));
}

/// The nodes that choose a colour in this step, and what they choose. Only these can clash later: a choice
/// avoids the colours of all neighbours that keep theirs.
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
    // most bodies find it high enough
    if (s.counters->colors <= color) atomicRaise(&s.counters->colors, color + 1);
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

/// One round: those that clashed take their choice, and choose again if a neighbour has made the same. Reads
/// `color`, writes `nextColor`, so that the order inside a round is of no consequence.
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

/// Does a body take part in the sweeps? They have nothing to add to what an exact tree has solved.
RUBBLE_HD inline bool isSwept(const SolverData& s, int i) { return isDynamic(s, i) && !inExactTree(s, i); }

/// Population of each colour.
struct CountColors {
  static constexpr const char* kStage = "coloring";
  RUBBLE_HD void operator()(const SolverData& s, int i) const {
    if (isSwept(s, i)) atomicCount(&s.colorCount[s.color[i]], 1);
  }
};

/// Bodies by colour. The order inside a colour has no influence on results: its bodies share nothing.
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
/// The order inside a colour has no influence on results.
struct FillVertexColors {
  static constexpr const char* kStage = "coloring";
  RUBBLE_HD void operator()(const SolverData& s, int v) const {
    if (!isDynamicVertex(s, v)) return;
    const int color = s.vertexColor[v];
    s.colorVertex[s.vertexColorOffset[color] + atomicCount(&s.vertexColorCount[color], -1) - 1] = v;
  }
};

}  // namespace rubble::RUBBLE_CORE
