#include "backend/cpu/soft_edit.h"

#include <algorithm>
#include <bit>

#include "stages/soft_step.h"

namespace rubble::RUBBLE_CORE {

namespace {

Real real(double a) { return static_cast<Real>(a); }
/// A threshold; "never" is a number that nothing reaches.
Real bound(double a) { return static_cast<Real>(std::min(a, 1e18)); }

/// An element that is all zeros, padding too: states are hashed.
template <class F, std::size_t N>
F fresh(const std::array<int, N>& v, int first) {
  F e;
  std::memset(static_cast<void*>(&e), 0, sizeof e);
  for (std::size_t k = 0; k < N; ++k) e.v[k] = first + v[k];
  e.alive = 1;
  return e;
}

Tetrahedron made(const SoftModel::Tetrahedron& m, int first) {
  Tetrahedron e = fresh<Tetrahedron>(m.v, first);
  for (int k = 0; k < 3; ++k) e.m[k] = Vec3(m.m[k]);
  e.mu = real(m.mu * m.volume), e.lambda = real(m.lambda * m.volume);
  e.volume = real(m.volume), e.viscosity = real(m.viscosity);
  return e;
}
Membrane made(const SoftModel::Membrane& m, int first) {
  Membrane e = fresh<Membrane>(m.v, first);
  for (int k = 0; k < 2; ++k) e.m1[k] = real(m.m1[k]), e.m2[k] = real(m.m2[k]), e.stiffness[k] = real(m.stiffness[k]);
  e.damper = real(m.damper), e.tearStretch = real(m.tearStretch), e.unit0 = real(m.unit), e.largest = real(m.largest);
  return e;
}
FlatBend made(const SoftModel::FlatBend& m, int first) {
  FlatBend e = fresh<FlatBend>(m.v, first);
  e.stiffness = real(m.stiffness);
  for (int k = 0; k < 4; ++k) e.weight[k] = real(m.weight[k]);
  return e;
}
FoldBend made(const SoftModel::FoldBend& m, int first) {
  FoldBend e = fresh<FoldBend>(m.v, first);
  e.stiffness = real(m.stiffness), e.damping = real(m.damping), e.restAngle = real(m.restAngle);
  return e;
}
LineBend made(const SoftModel::LineBend& m, int first) {
  LineBend e = fresh<LineBend>(m.v, first);
  e.stiffness = real(m.stiffness);
  for (int k = 0; k < 3; ++k) e.weight[k] = real(m.weight[k]);
  return e;
}
Spring made(const SoftModel::Spring& m, int first) {
  Spring e = fresh<Spring>(m.v, first);
  e.stiffness = real(m.stiffness), e.damping = real(m.damping), e.restLength = real(m.restLength);
  e.bound = bound(m.bound), e.mass = real(m.mass);
  return e;
}

template <class F>
const auto& listOf(const SoftModel& m) {
  if constexpr (std::is_same_v<F, Tetrahedron>) return m.tetrahedra;
  else if constexpr (std::is_same_v<F, Membrane>) return m.membranes;
  else if constexpr (std::is_same_v<F, FlatBend>) return m.flatBends;
  else if constexpr (std::is_same_v<F, FoldBend>) return m.foldBends;
  else if constexpr (std::is_same_v<F, LineBend>) return m.lineBends;
  else return m.springs;
}
static_assert(ElementTypes::kSize == SoftRange::kElementTypes);

Attachment made(const EngineAttachment& in) {
  Attachment a;
  std::memset(static_cast<void*>(&a), 0, sizeof a);
  for (int k = 0; k < kPointCorners; ++k) a.v[k] = in.v[k], a.weight[k] = real(in.weight[k]);
  a.body = in.body, a.seam = in.seam, a.alive = 1;
  a.worldPoint = in.worldPoint, a.anchor = Vec3(in.anchor);
  a.bound = bound(in.bound), a.compliance = real(in.compliance);
  a.length = real(in.length), a.mass = real(in.mass);
  return a;
}

/// Elements of all objects, those that were there with their state.
template <class F>
void placeElements(HostTables& tables, const std::vector<EngineSoftObject>& objects) {
  constexpr int kType = typeIndex<F>(ElementTypes{});
  View& s = tables.view();
  const std::vector<F> old(s.elementsOf<F>(), s.elementsOf<F>() + s.elements[kType]);
  int count = 0;
  for (const EngineSoftObject& o : objects) count += static_cast<int>(listOf<F>(*o.model).size());
  tables.reserve(perElement<F>(), count);
  s.elements[kType] = count;
  for (const EngineSoftObject& o : objects) {
    F* to = s.elementsOf<F>() + o.at.element[kType];
    for (std::size_t i = 0; i < listOf<F>(*o.model).size(); ++i, ++to) {
      if (o.previous.vertex < 0) {
        *to = made(listOf<F>(*o.model)[i], o.at.vertex);
        continue;
      }
      *to = old[static_cast<std::size_t>(o.previous.element[kType]) + i];
      for (int& v : to->v) v += o.at.vertex - o.previous.vertex;
    }
  }
}

void placeAttachments(HostTables& tables, const std::vector<EngineAttachment>& attachments) {
  View& s = tables.view();
  const std::vector<Attachment> old(s.attachment, s.attachment + s.attachments);
  tables.reserve(Per::Attachment, static_cast<int>(attachments.size()));
  s.attachments = static_cast<int>(attachments.size());
  for (std::size_t i = 0; i < attachments.size(); ++i) {
    Attachment& to = s.attachment[i];
    to = made(attachments[i]);
    if (attachments[i].previous < 0) continue;
    const Attachment& from = old[static_cast<std::size_t>(attachments[i].previous)];
    to.broken = from.broken, to.lambda = from.lambda, to.k = from.k;
  }
}

/// Which elements and attachments act on each vertex, and which vertices share one.
void connect(HostTables& tables) {
  View& s = tables.view();
  std::vector<std::pair<int, std::uint32_t>> refs;
  std::vector<std::pair<int, int>> neighbors;
  const auto add = [&](int type, int index, const int* v, int corners) {
    for (int a = 0; a < corners && v[a] >= 0; ++a) {
      if (!isDynamicVertex(s, v[a])) continue;
      refs.emplace_back(v[a], pointCode(type, index, a));
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
  std::sort(neighbors.begin(), neighbors.end());
  neighbors.erase(std::unique(neighbors.begin(), neighbors.end()), neighbors.end());
  tables.reserve(Per::ElementRef, static_cast<int>(refs.size()));
  tables.reserve(Per::Neighbor, static_cast<int>(neighbors.size()));
  const auto fill = [&](const auto& pairs, int* offset, auto* to) {
    std::size_t k = 0;
    for (int v = 0; v < s.vertices; ++v) {
      offset[v] = static_cast<int>(k);
      for (; k < pairs.size() && pairs[k].first == v; ++k) to[k] = pairs[k].second;
    }
    offset[s.vertices] = static_cast<int>(k);
  };
  fill(refs, s.refOffset, s.ref);
  fill(neighbors, s.neighborOffset, s.neighbor);
}

static_assert(kClusterLevels == SoftModel::kClusterLevels);

/// The clusters of all objects by level, and the elements that leave each.
void placeClusters(HostTables& tables, const std::vector<EngineSoftObject>& objects) {
  View& s = tables.view();
  std::vector<std::pair<int, int>> byLevel[kClusterLevels];  // object, its cluster
  std::vector<std::vector<int>> number(objects.size());
  for (std::size_t o = 0; o < objects.size(); ++o) {
    number[o].resize(objects[o].model->clusters.size());
    for (std::size_t c = 0; c < number[o].size(); ++c)
      byLevel[objects[o].model->clusters[c].level].emplace_back(static_cast<int>(o), static_cast<int>(c));
  }
  int count = 0;
  for (int level = 0; level < kClusterLevels; ++level) {
    s.clusterBegin[level] = count;
    for (const auto& [o, c] : byLevel[level]) number[static_cast<std::size_t>(o)][static_cast<std::size_t>(c)] = count++;
  }
  s.clusterBegin[kClusterLevels] = count;
  tables.reserve(Per::Cluster, count);

  // members of an object are one range; parts of a cluster come one after another in it
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
      to = {memberBegin[object] + in.begin, memberBegin[object] + in.end, own, own + 1, 0, 0,
            in.parent < 0 ? -1 : number[object][static_cast<std::size_t>(in.parent)]};
      if (in.parent < 0)
        for (int k = to.begin; k < to.end; ++k) s.vertexParams[s.clusterMember[k]].cluster = own;
      if (level > 0) to.chunkBegin = count, to.chunkEnd = -1;
      for (int k = to.begin; k < to.end; ++k) clusterOf[static_cast<std::size_t>(s.clusterMember[k]) * kClusterLevels + static_cast<std::size_t>(level)] = own;
    }
  for (int c = 0; c < count; ++c) {
    const int parent = s.cluster[c].parent;
    if (parent < 0) continue;
    s.cluster[parent].chunkBegin = std::min(s.cluster[parent].chunkBegin, s.cluster[c].chunkBegin);
    s.cluster[parent].chunkEnd = std::max(s.cluster[parent].chunkEnd, s.cluster[c].chunkEnd);
  }

  std::vector<std::pair<int, ClusterRef>> refs;
  forEachType(ElementTypes{}, [&]<class F>() {
    constexpr int kType = typeIndex<F>(ElementTypes{});
    for (int i = 0; i < s.elements[kType]; ++i)
      for (int level = 0; level < kClusterLevels; ++level) {
        int own[F::kCorners], different = 0;
        for (int k = 0; k < F::kCorners; ++k)
          own[k] = clusterOf[static_cast<std::size_t>(s.elementsOf<F>()[i].v[k]) * kClusterLevels + static_cast<std::size_t>(level)];
        for (int k = 0; k < F::kCorners; ++k) different += std::find(own, own + k, own[k]) == own + k;
        if (different < 2) continue;
        for (int k = 0; k < F::kCorners; ++k) {
          if (own[k] < 0 || std::find(own, own + k, own[k]) != own + k) continue;
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

/// What vertices have that lasts, by old index.
struct OldVertices {
  explicit OldVertices(const View& s)
      : position(s.vertexPosition, s.vertexPosition + s.vertices),
        velocity(s.vertexVelocity, s.vertexVelocity + s.vertices),
        oldVelocity(s.vertexOldVelocity, s.vertexOldVelocity + s.vertices),
        force(s.vertexForce, s.vertexForce + s.vertices),
        color(s.vertexColor, s.vertexColor + s.vertices),
        offset(s.oldPointPairOffset, s.oldPointPairOffset + s.vertices + 1),
        pair(s.oldPointPair, s.oldPointPair + offset.back()),
        contact(s.oldPointContact, s.oldPointContact + offset.back()) {}
  std::vector<Vec3d> position;
  std::vector<Vec3> velocity, oldVelocity, force;
  std::vector<int> color, offset;
  std::vector<PointPair> pair;
  std::vector<PointContact> contact;
};

/// Contacts of the last step between vertices that are still there. `origin`: old index of each vertex; `now`: new index of each old one.
void placeContacts(HostTables& tables, const OldVertices& old, const std::vector<int>& origin, const std::vector<int>& now) {
  tables.reserve(Per::PointPair, static_cast<int>(old.pair.size()));
  View& s = tables.view();
  int n = 0;
  for (int v = 0; v < s.vertices; ++v) {
    s.oldPointPairOffset[v] = n;
    const int from = origin[static_cast<std::size_t>(v)];
    if (from < 0) continue;
    for (int k = old.offset[static_cast<std::size_t>(from)]; k < old.offset[static_cast<std::size_t>(from) + 1]; ++k) {
      PointPair pair = old.pair[static_cast<std::size_t>(k)];
      PointContact contact = old.contact[static_cast<std::size_t>(k)];
      pair.vertex = v;
      if (pair.other >= kVertexNode) {
        const int other = now[static_cast<std::size_t>(pair.other - kVertexNode)];
        if (other < 0) continue;
        pair.other = kVertexNode + other;
      }
      for (int& corner : contact.v)
        if (corner >= 0) corner = now[static_cast<std::size_t>(corner)];
      s.oldPointPair[n] = pair;
      s.oldPointContact[n++] = contact;
    }
  }
  s.oldPointPairOffset[s.vertices] = n;
}

void reserveVertices(HostTables& tables, int vertices) {
  if (vertices == 0) return;
  tables.reserve(Per::Vertex, vertices);
  tables.reserve(Per::VertexSlot, tables.capacity(Per::Vertex) * kPointPairSlots);
  tables.reserve(Per::Node, tables.capacity(Per::Body) + tables.capacity(Per::Vertex));
}

}  // namespace

void setSoft(HostTables& tables, const std::vector<EngineSoftObject>& objects, const std::vector<EngineAttachment>& attachments) {
  View& s = tables.view();
  const OldVertices old(s);
  int vertices = 0;
  for (const EngineSoftObject& o : objects) vertices += static_cast<int>(o.model->vertices.size());
  reserveVertices(tables, vertices);
  std::vector<int> origin(static_cast<std::size_t>(vertices), -1), now(old.position.size(), -1);
  s.vertices = vertices;
  Real widest = 0;
  for (const EngineSoftObject& o : objects) {
    const SoftModel& m = *o.model;
    double meanLength = 0;
    for (const SoftModel::Vertex& in : m.vertices) meanLength += in.length / static_cast<double>(m.vertices.size());
    for (std::size_t i = 0; i < m.vertices.size(); ++i) {
      const SoftModel::Vertex& in = m.vertices[i];
      const int v = o.at.vertex + static_cast<int>(i);
      VertexParams& p = s.vertexParams[v];
      p.kind = in.mass > 0 ? VertexKind::Dynamic : VertexKind::Fixed;
      p.mass = real(in.mass), p.radius = real(in.radius), p.length = real(in.length);
      p.muStatic = real(m.material.staticFriction), p.muDynamic = real(m.material.dynamicFriction);
      p.restitution = real(m.material.restitution);
      p.frictionCombine = static_cast<int>(m.material.frictionCombine);
      p.restitutionCombine = static_cast<int>(m.material.restitutionCombine);
      p.gravityScale = real(m.gravityScale);
      p.first = o.at.vertex, p.collides = m.collides;
      p.cluster = -1, p.reach = real(meanLength);
      if (p.collides & kCollidesWithGrains) widest = max(widest, p.radius);
      if (o.previous.vertex < 0) {
        s.vertexPosition[v] = in.position;
        s.vertexVelocity[v] = s.vertexOldVelocity[v] = Vec3(in.velocity);
        s.vertexForce[v] = {0, 0, 0};
        s.vertexColor[v] = 0;
        continue;
      }
      const std::size_t from = static_cast<std::size_t>(o.previous.vertex) + i;
      s.vertexPosition[v] = old.position[from];
      s.vertexVelocity[v] = old.velocity[from], s.vertexOldVelocity[v] = old.oldVelocity[from];
      s.vertexForce[v] = old.force[from], s.vertexColor[v] = old.color[from];
      origin[static_cast<std::size_t>(v)] = static_cast<int>(from);
      now[from] = v;
    }
  }
  // cells a little wider than the largest particle
  s.grainCell = widest > Real(0) ? Real(2.2) * widest : Real(1);
  s.grainCells = widest > Real(0) ? static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::max(64, 2 * vertices)))) : 0;
  tables.reserve(Per::GrainCell, s.grainCells);
  forEachType(ElementTypes{}, [&]<class F>() { placeElements<F>(tables, objects); });
  placeAttachments(tables, attachments);
  connect(tables);
  placeClusters(tables, objects);
  placeContacts(tables, old, origin, now);
}

SoftCounts softCounts(const View& s) {
  SoftCounts c{s.vertices, s.refOffset[s.vertices], s.neighborOffset[s.vertices], s.grainCells, s.attachments, {}, {}, s.clusterRefs, static_cast<float>(s.grainCell)};
  std::copy(std::begin(s.clusterBegin), std::end(s.clusterBegin), c.clusterBegin);
  std::copy(std::begin(s.elements), std::end(s.elements), c.elements);
  return c;
}

void setSoftCounts(HostTables& tables, const SoftCounts& c) {
  reserveVertices(tables, c.vertices);
  tables.reserve(Per::ElementRef, c.refs);
  tables.reserve(Per::Neighbor, c.neighbors);
  tables.reserve(Per::GrainCell, c.grainCells);
  tables.reserve(Per::Attachment, c.attachments);
  tables.reserve(Per::Cluster, c.clusterBegin[kClusterLevels]);
  tables.reserve(Per::ClusterRef, c.clusterRefs);
  View& s = tables.view();
  s.vertices = c.vertices, s.grainCells = c.grainCells, s.attachments = c.attachments;
  s.grainCell = real(c.grainCell);
  s.clusterRefs = c.clusterRefs;
  std::copy(std::begin(c.clusterBegin), std::end(c.clusterBegin), s.clusterBegin);
  s.refOffset[c.vertices] = c.refs;
  s.neighborOffset[c.vertices] = c.neighbors;
  forEachType(ElementTypes{}, [&]<class F>() {
    constexpr int kType = typeIndex<F>(ElementTypes{});
    tables.reserve(perElement<F>(), c.elements[kType]);
    s.elements[kType] = c.elements[kType];
  });
}

void vertexStatesOf(const HostTables& tables, int first, std::span<rubble::Vec3> positions, std::span<rubble::Vec3> velocities) {
  const View& s = tables.view();
  for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = s.vertexPosition[static_cast<std::size_t>(first) + i];
  for (std::size_t i = 0; i < velocities.size(); ++i) velocities[i] = rubble::Vec3(s.vertexVelocity[static_cast<std::size_t>(first) + i]);
}

void setVertexStates(HostTables& tables, int first, std::span<const rubble::Vec3> positions, std::span<const rubble::Vec3> velocities) {
  View& s = tables.view();
  for (std::size_t i = 0; i < positions.size(); ++i) s.vertexPosition[static_cast<std::size_t>(first) + i] = positions[i];
  for (std::size_t i = 0; i < velocities.size(); ++i) {
    const std::size_t v = static_cast<std::size_t>(first) + i;
    if (s.vertexParams[v].kind == VertexKind::Dynamic) s.vertexVelocity[v] = s.vertexOldVelocity[v] = Vec3(velocities[i]);
  }
}

void elementsAliveOf(const HostTables& tables, int type, int first, std::span<char> alive) {
  const View& s = tables.view();
  forEachType(ElementTypes{}, [&]<class F>() {
    if (typeIndex<F>(ElementTypes{}) != type) return;
    for (std::size_t i = 0; i < alive.size(); ++i) alive[i] = s.elementsOf<F>()[static_cast<std::size_t>(first) + i].alive != 0;
  });
}

JointState attachmentStateOf(const HostTables& tables, int index) {
  const View& s = tables.view();
  const Attachment& a = s.attachment[index];
  Vec3d gap;
  for (int k = 0; k < kPointCorners && a.v[k] >= 0; ++k) gap += s.vertexPosition[a.v[k]] * static_cast<double>(a.weight[k]);
  if (a.seam == 0) gap += a.body == kWorldBody ? a.worldPoint : s.position[a.body] + Vec3d(rotate(s.orientation[a.body], a.anchor));
  JointState state;
  state.gap = length(gap);
  // on the vertices (B); the rows push C down
  state.force = Vec3d(a.lambda);
  state.broken = a.broken != 0;
  return state;
}

std::vector<EngineVertexContact> vertexContactsOf(const HostTables& tables) {
  const View& s = tables.view();
  std::vector<EngineVertexContact> out;
  for (int k = 0; k < s.oldPointPairOffset[s.vertices]; ++k) {
    const PointContact& p = s.oldPointContact[k];
    if (!p.active) continue;
    Vec3 t1, t2;
    tangentBasis(p.n, t1, t2);
    double depth;
    int vertex = p.v[0], other = -1;
    if (p.body >= 0) {
      depth = static_cast<double>(s.vertexParams[vertex].radius - pointToBody(s, vertex, p.body, s.vertexParams[vertex].length, p.n).distance);
    } else {
      other = p.v[1];
      depth = static_cast<double>(s.vertexParams[vertex].radius + s.vertexParams[other].radius) -
              length(s.vertexPosition[other] - s.vertexPosition[vertex]);
    }
    if (depth < 0 && !(p.lambdaN > Real(0))) continue;
    out.push_back({vertex, p.body, other, Vec3d(p.n), Vec3d(p.n * p.lambdaN + t1 * p.lambda1 + t2 * p.lambda2), depth});
  }
  return out;
}

void addSoftQuality(const HostTables& tables, Quality& q, std::vector<double>& depths, int& joints) {
  const View& s = tables.view();
  if (s.vertices == 0) return;
  for (const EngineVertexContact& c : vertexContactsOf(tables)) depths.push_back(std::max(0.0, c.depth));
  for (int i = 0; i < s.attachments; ++i) {
    if (!active(s, s.attachment[i])) continue;
    const double gap = attachmentStateOf(tables, i).gap;
    q.jointGapMean += gap;
    q.jointGapMax = std::max(q.jointGapMax, gap);
    ++joints;
  }
  for (int v = 0; v < s.vertices; ++v) {
    if (!isDynamicVertex(s, v)) continue;
    const VertexParams& p = s.vertexParams[v];
    const double v2 = dot(Vec3d(s.vertexVelocity[v]), Vec3d(s.vertexVelocity[v]));
    q.kineticEnergy += .5 * static_cast<double>(p.mass) * v2;
    q.potentialEnergy -= static_cast<double>(p.mass * p.gravityScale) * dot(Vec3d(s.step.gravity), s.vertexPosition[v]);
    q.maxSpeed = std::max(q.maxSpeed, std::sqrt(v2));
  }
}

void forgetVertexContacts(HostTables& tables, int body) {
  View& s = tables.view();
  for (int k = 0; k < s.oldPointPairOffset[s.vertices]; ++k)
    if (s.oldPointPair[k].other == body) {
      s.oldPointPair[k].other = -1;
      s.oldPointContact[k].active = 0;
    }
}

}  // namespace rubble::RUBBLE_CORE
