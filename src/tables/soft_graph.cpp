#include "tables/soft_graph.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <numeric>

#include "stages/soft/cluster_phases.h"

namespace rubble::RUBBLE_CORE {

namespace {

/// An element with its corners permuted so that `corner` comes first.
TetraCorner seenFrom(const Tetrahedron& e, int index, int corner) {
  TetraCorner t;
  std::memset(static_cast<void*>(&t), 0, sizeof t);  // clears padding: states are hashed
  t.mu = e.mu, t.lambda = e.lambda, t.damper = e.damper;
  t.element = index;
  for (int k = 0, n = 0; k < Tetrahedron::kCorners; ++k)
    if (k != corner) t.other[n++] = e.v[k];
  t.takeShape(e);
  return t;
}

}  // namespace

/// Lists the elements and attachments of each vertex, and the vertices that share one.
void connect(HostTables& tables) {
  SolverData& s = tables.view();
  constexpr int kTetrahedron = typeIndex<Tetrahedron>(ElementTypes{});
  std::vector<std::pair<int, std::uint32_t>> refs, tetrahedra;
  std::vector<std::pair<int, int>> neighbors;
  const auto add = [&](int type, int index, const int* v, int corners) {
    for (int a = 0; a < corners && v[a] >= 0; ++a) {
      if (!isDynamicVertex(s, v[a])) continue;
      (type == kTetrahedron ? tetrahedra : refs).emplace_back(v[a], pointCode(type, index, a));
      for (int b = 0; b < corners && v[b] >= 0; ++b)
        if (v[a] != v[b] && isDynamicVertex(s, v[b])) neighbors.emplace_back(v[a], v[b]);
    }
  };
  forEachType(ElementTypes{}, [&]<class F>() {
    constexpr int kType = typeIndex<F>(ElementTypes{});
    for (int i = 0; i < s.elements[kType]; ++i) add(kType, i, s.elementsOf<F>()[i].v, F::kCorners);
  });
  for (int i = 0; i < s.attachments; ++i) add(kAttachmentCode, i, s.attachment[i].v, kPointCorners);
  std::sort(refs.begin(), refs.end());
  std::sort(tetrahedra.begin(), tetrahedra.end());
  std::sort(neighbors.begin(), neighbors.end());
  neighbors.erase(std::unique(neighbors.begin(), neighbors.end()), neighbors.end());
  tables.reserve(Per::ElementRef, static_cast<int>(refs.size()));
  tables.reserve(Per::Neighbor, static_cast<int>(neighbors.size()));
  tables.reserve(Per::TetraCorner, static_cast<int>(tetrahedra.size()));
  const auto fill = [&](const auto& pairs, int* offset, auto&& write) {
    std::size_t k = 0;
    for (int v = 0; v < s.vertices; ++v) {
      offset[v] = static_cast<int>(k);
      for (; k < pairs.size() && pairs[k].first == v; ++k) write(k, pairs[k].second);
    }
    offset[s.vertices] = static_cast<int>(k);
  };
  fill(refs, s.refOffset, [&](std::size_t k, std::uint32_t code) { s.ref[k] = code; });
  fill(neighbors, s.neighborOffset, [&](std::size_t k, int v) { s.neighbor[k] = v; });
  fill(tetrahedra, s.tetraCornerOffset, [&](std::size_t k, std::uint32_t code) {
    s.tetraCorner[k] = seenFrom(s.elementsOf<Tetrahedron>()[pointIndex(code)], pointIndex(code),
                                pointCorner(code));
  });
}

static_assert(kClusterLevels == SoftModel::kClusterLevels);

/// Returns whether a cluster is moved as a rigid unit. Clusters of the finest level of a solid are not: they
/// only hold partial sums. Clusters of the next level are about four vertices wide, a distance that vertex
/// sweeps handle.
bool movesAsOne(const SoftModel& model, const SoftModel::Cluster& c) {
  return c.level > 0 || c.parent < 0 || model.list<TetrahedronModel>().empty();
}

/// Places the clusters of all objects by level, and lists the boundary elements of each.
void placeClusters(HostTables& tables, const std::vector<EngineSoftObject>& objects) {
  SolverData& s = tables.view();
  std::vector<std::pair<int, int>> byLevel[kClusterLevels];  // (object, cluster)
  std::vector<std::vector<int>> number(objects.size());
  for (std::size_t o = 0; o < objects.size(); ++o) {
    number[o].resize(objects[o].model->clusters.size());
    for (std::size_t c = 0; c < number[o].size(); ++c)
      byLevel[objects[o].model->clusters[c].level].emplace_back(static_cast<int>(o), static_cast<int>(c));
  }
  const auto moves = [&](const std::pair<int, int>& of) {
    const SoftModel& model = *objects[static_cast<std::size_t>(of.first)].model;
    return movesAsOne(model, model.clusters[static_cast<std::size_t>(of.second)]);
  };
  s.movingParts = static_cast<int>(std::stable_partition(byLevel[0].begin(), byLevel[0].end(), moves) -
                                   byLevel[0].begin());
  int count = 0;
  for (int level = 0; level < kClusterLevels; ++level) {
    s.clusterBegin[level] = count;
    for (const auto& [o, c] : byLevel[level])
      number[static_cast<std::size_t>(o)][static_cast<std::size_t>(c)] = count++;
  }
  s.clusterBegin[kClusterLevels] = count;
  tables.reserve(Per::Cluster, count);

  // the vertices of an object are one range, and those of a cluster are contiguous in it
  std::vector<int> memberBegin, clusterOf(static_cast<std::size_t>(s.vertices) * kClusterLevels, -1);
  int members = 0;
  for (const EngineSoftObject& o : objects) {
    memberBegin.push_back(members);
    for (const int v : o.model->clusterOrder) s.clusterMember[members++] = o.at.vertex + v;
  }
  for (int level = 0; level < kClusterLevels; ++level)
    for (const auto& [o, c] : byLevel[level]) {
      const std::size_t object = static_cast<std::size_t>(o);
      const SoftModel::Cluster& in = objects[object].model->clusters[static_cast<std::size_t>(c)];
      const int own = number[object][static_cast<std::size_t>(c)];
      Cluster& to = s.cluster[own];
      to = {memberBegin[object] + in.begin,
            memberBegin[object] + in.end,
            own,
            own + 1,
            0,
            0,
            in.parent < 0 ? -1 : number[object][static_cast<std::size_t>(in.parent)]};
      if (in.parent < 0)
        for (int k = to.begin; k < to.end; ++k) s.vertexParams[s.clusterMember[k]].cluster = own;
      if (level > 0) to.sliceBegin = count, to.sliceEnd = -1;
      for (int k = to.begin; k < to.end; ++k)
        clusterOf[static_cast<std::size_t>(s.clusterMember[k]) * kClusterLevels +
                  static_cast<std::size_t>(level)] = own;
    }
  for (int c = 0; c < count; ++c) {
    const int parent = s.cluster[c].parent;
    if (parent < 0) continue;
    s.cluster[parent].sliceBegin = std::min(s.cluster[parent].sliceBegin, s.cluster[c].sliceBegin);
    s.cluster[parent].sliceEnd = std::max(s.cluster[parent].sliceEnd, s.cluster[c].sliceEnd);
  }

  std::vector<std::pair<int, ClusterRef>> refs;
  forEachType(ElementTypes{}, [&]<class F>() {
    constexpr int kType = typeIndex<F>(ElementTypes{});
    for (int i = 0; !kIsLoad<F> && i < s.elements[kType]; ++i)
      for (int level = 0; level < kClusterLevels; ++level) {
        int own[F::kCorners], different = 0;
        for (int k = 0; k < F::kCorners; ++k)
          own[k] = clusterOf[static_cast<std::size_t>(s.elementsOf<F>()[i].v[k]) * kClusterLevels +
                             static_cast<std::size_t>(level)];
        for (int k = 0; k < F::kCorners; ++k) different += std::find(own, own + k, own[k]) == own + k;
        if (different < 2) continue;
        for (int k = 0; k < F::kCorners; ++k) {
          if (own[k] < 0 || std::find(own, own + k, own[k]) != own + k) continue;
          if (level == 0 && own[k] >= s.movingParts) continue;
          ClusterRef ref{kType, i, 0, different};
          for (int j = 0; j < F::kCorners; ++j)
            if (own[j] == own[k]) ref.inside |= 1u << j;
          refs.emplace_back(own[k], ref);
        }
      }
  });
  std::stable_sort(refs.begin(), refs.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  tables.reserve(Per::ClusterRef, static_cast<int>(refs.size()));
  s.clusterRefs = static_cast<int>(refs.size());
  std::size_t k = 0;
  for (int c = 0; c < count; ++c) {
    s.cluster[c].refBegin = static_cast<int>(k);
    for (; k < refs.size() && refs[k].first == c; ++k) s.clusterRef[k] = refs[k].second;
    s.cluster[c].refEnd = static_cast<int>(k);
  }
}

void placeSoftNodes(HostTables& tables, const std::vector<EngineSoftObject>& objects) {
  SolverData& s = tables.view();
  for (int v = 0; v < s.vertices; ++v) s.vertexParams[v].softNode = -1;
  std::vector<SoftNode> softNodes;
  for (const EngineSoftObject& o : objects) {
    if (!isSoftNode(*o.model)) continue;
    const int own = static_cast<int>(softNodes.size()),
              cluster = s.vertexParams[o.at.vertex + o.model->clusterOrder.front()].cluster;
    for (const int v : o.model->clusterOrder) s.vertexParams[o.at.vertex + v].softNode = own;
    softNodes.push_back({o.at.vertex, cluster, static_cast<Real>(o.model->size / 2)});
  }
  s.objects = static_cast<int>(softNodes.size());
  for (const EngineSoftObject& o : objects) {
    if (!hasNoElements(*o.model)) continue;
    for (int v = o.at.vertex; v < o.at.vertex + static_cast<int>(o.model->vertices.size()); ++v) {
      if (!isDynamicVertex(s, v)) continue;
      s.vertexParams[v].softNode = static_cast<int>(softNodes.size());
      softNodes.push_back({v, -1, s.vertexParams[v].radius});
    }
  }
  s.softNodes = static_cast<int>(softNodes.size());
  tables.reserve(Per::SoftNode, s.softNodes);
  reserveNodes(tables);
  std::ranges::copy(softNodes, &s.softNode[0]);
}

namespace {

/// Springs at a vertex, and the vertices at their other ends.
struct LineEnds {
  int count = 0;
  int spring[2] = {-1, -1}, other[2] = {-1, -1};
};

/// The connections of an object that consists of springs and their bends only. Empty if it has other elements
/// or a branch.
std::vector<LineEnds> lineEnds(const SoftModel& m) {
  const auto counts = elementCounts(m);
  const std::size_t elements = static_cast<std::size_t>(std::accumulate(counts.begin(), counts.end(), 0));
  const auto& springs = m.list<SpringModel>();
  if (springs.empty() || elements != springs.size() + m.list<LineBend::Model>().size()) return {};
  std::vector<LineEnds> ends(m.vertices.size());
  for (std::size_t i = 0; i < springs.size(); ++i)
    for (std::size_t k = 0; k < 2; ++k) {
      LineEnds& end = ends[static_cast<std::size_t>(springs[i].v[k])];
      if (end.count == 2) return {};
      end.spring[end.count] = static_cast<int>(i), end.other[end.count++] = springs[i].v[1 - k];
    }
  return ends;
}

}  // namespace

void placeStrands(HostTables& tables, const std::vector<EngineSoftObject>& objects) {
  SolverData& s = tables.view();
  std::vector<Strand> lines;
  std::vector<StrandVertex> vertices;
  for (const EngineSoftObject& o : objects) {
    const SoftModel& m = *o.model;
    const std::vector<LineEnds> ends = lineEnds(m);
    // the first vertex of a bend is its middle
    std::vector<int> bendAt(ends.size(), -1);
    if (!ends.empty())
      for (std::size_t i = 0; i < m.list<LineBend::Model>().size(); ++i)
        bendAt[static_cast<std::size_t>(m.list<LineBend::Model>()[i].v[0])] = static_cast<int>(i);
    const auto global = [&](int type, int index) { return index < 0 ? -1 : o.at.element[type] + index; };
    std::vector<char> done(ends.size(), 0);
    for (std::size_t first = 0; first < ends.size(); ++first) {
      if (ends[first].count != 1 || done[first]) continue;
      const int line = static_cast<int>(lines.size()), begin = static_cast<int>(vertices.size());
      for (int v = static_cast<int>(first), came = -1; v >= 0;) {
        const LineEnds& end = ends[static_cast<std::size_t>(v)];
        const int way = end.spring[0] != came ? 0 : 1, spring = end.spring[way];
        done[static_cast<std::size_t>(v)] = 1;
        vertices.push_back(
            {o.at.vertex + v, line, global(typeIndex<Spring>(ElementTypes{}), spring),
             global(typeIndex<LineBend>(ElementTypes{}), bendAt[static_cast<std::size_t>(v)])});
        v = end.other[way], came = spring;
      }
      lines.push_back({begin, static_cast<int>(vertices.size())});
    }
  }
  s.strands = static_cast<int>(lines.size()), s.strandVertices = static_cast<int>(vertices.size());
  tables.reserve(Per::Strand, s.strands);
  tables.reserve(Per::StrandVertex, s.strandVertices);
  std::ranges::copy(lines, &s.strand[0]);
  std::ranges::copy(vertices, &s.strandVertex[0]);
}

/// Places edges and triangles of all colliding surfaces, and sizes their grid.
void placeFeatures(HostTables& tables, const std::vector<EngineSoftObject>& objects) {
  SolverData& s = tables.view();
  int edges = 0, triangles = 0;
  double shortest = 0;
  for (const EngineSoftObject& o : objects) {
    if (o.model->faces.empty() && o.model->edges.empty()) continue;
    edges += static_cast<int>(o.model->edges.size()), triangles += static_cast<int>(o.model->faces.size());
    shortest = shortest > 0 ? std::min(shortest, o.model->meanEdge) : o.model->meanEdge;
  }
  s.edges = edges, s.features = edges + triangles;
  // a swept triangle box is slightly wider than its edges are long
  constexpr double kCellEdges = 1.25;
  // a number that SoftCounts holds without loss
  s.featureCell = static_cast<Real>(static_cast<float>(shortest > 0 ? kCellEdges * shortest : 1));
  s.featureCells = s.features > 0
                       ? static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::max(64, 2 * s.features))))
                       : 0;
  reserveFeatures(tables, s);
  int edge = 0, triangle = edges;
  for (const EngineSoftObject& o : objects) {
    const int firstEdge = edge;
    const auto sourceOf = [&](const SoftModel::Source& source) {
      return source.type < 0 ? kNoSource
                             : pointCode(source.type, o.at.element[source.type] + source.index, 0);
    };
    for (const SoftModel::SurfaceEdge& e : o.model->edges)
      s.feature[edge++] = {e.bare ? FeatureKind::BareEdge : FeatureKind::Edge,
                           {o.at.vertex + e.v[0], o.at.vertex + e.v[1], -1},
                           {-1, -1, -1},
                           {e.opposite[0] < 0 ? -1 : o.at.vertex + e.opposite[0],
                            e.opposite[1] < 0 ? -1 : o.at.vertex + e.opposite[1]},
                           {sourceOf(e.source[0]), sourceOf(e.source[1])}};
    for (const SoftModel::SurfaceFace& f : o.model->faces) {
      SurfaceFeature to{FeatureKind::Triangle, {}, {}, {-1, -1}, {sourceOf(f.source), kNoSource}};
      for (std::size_t k = 0; k < 3; ++k) to.v[k] = o.at.vertex + f.v[k], to.edge[k] = firstEdge + f.edge[k];
      s.feature[triangle++] = to;
    }
  }
}

void reserveFeatures(HostTables& tables, const SolverData& s) {
  if (s.vertices == 0) return;
  tables.reserve(Per::Feature, s.features);
  tables.reserve(Per::FeatureCell, s.featureCells);
  tables.reserve(Per::PointOwner, s.owners());
  tables.reserve(Per::PointOwnerSlot, tables.capacity(Per::PointOwner) * kPointPairSlots);
}

}  // namespace rubble::RUBBLE_CORE
