#include "tables/soft_edit.h"

#include <algorithm>
#include <array>
#include <bit>
#include <map>

#include "stages/soft/cluster_phases.h"
#include "tables/soft_graph.h"

namespace rubble::RUBBLE_CORE {

namespace {

Real real(double a) { return static_cast<Real>(a); }
/// An element from its model. Padding is zeroed, because states are hashed.
template <class F> F made(const typename F::Model& model, int first) {
  F e;
  std::memset(static_cast<void*>(&e), 0, sizeof e);
  for (int k = 0; k < F::kCorners; ++k) e.v[k] = first + model.v[static_cast<std::size_t>(k)];
  e.alive = 1;
  e.set(model);
  return e;
}

Attachment made(const EngineAttachment& in) {
  Attachment a;
  std::memset(static_cast<void*>(&a), 0, sizeof a);
  for (int k = 0; k < kPointCorners; ++k) a.v[k] = in.v[k], a.weight[k] = real(in.weight[k]);
  a.body = in.body, a.isVertexVertex = in.isVertexVertex, a.alive = 1;
  a.worldPoint = in.worldPoint, a.anchor = Vec3(in.anchor);
  a.bound = thresholdOf(in.bound), a.compliance = real(in.compliance);
  a.length = real(in.length), a.mass = real(in.mass);
  return a;
}

/// Indices of elements by their corners.
template <class F>
std::map<std::array<int, F::kCorners>, std::size_t> byCorners(const std::vector<typename F::Model>& models) {
  std::map<std::array<int, F::kCorners>, std::size_t> out;
  for (std::size_t i = 0; i < models.size(); ++i) out.emplace(models[i].v, i);
  return out;
}

/// Changes the authored data of an element and keeps its state.
template <class F> void redefine(F& element, const typename F::Model& model) {
  if constexpr (requires { element.redefine(model); })
    element.redefine(model);
  else
    element.set(model);
}

/// Writes the elements of all objects. Elements that existed before keep their state. In an object with a new
/// model they are those of the same corners.
template <class F> void placeElements(HostTables& tables, const std::vector<EngineSoftObject>& objects) {
  constexpr int kType = typeIndex<F>(ElementTypes{});
  SolverData& s = tables.view();
  const std::vector<F> old(s.elementsOf<F>(), s.elementsOf<F>() + s.elements[kType]);
  int count = 0;
  for (const EngineSoftObject& o : objects) count += elementCounts(*o.model)[kType];
  tables.reserve(perElement<F>(), count);
  s.elements[kType] = count;
  for (const EngineSoftObject& o : objects) {
    F* to = s.elementsOf<F>() + o.at.element[kType];
    const auto& models = o.model->list<typename F::Model>();
    const auto indices = o.before ? byCorners<F>(o.before->list<typename F::Model>())
                                  : decltype(byCorners<F>(models)){};
    for (std::size_t i = 0; i < models.size(); ++i, ++to) {
      const auto found = indices.find(models[i].v);
      if (o.previous.vertex < 0 || (o.before && found == indices.end())) {
        *to = made<F>(models[i], o.at.vertex);
        continue;
      }
      const std::size_t from = o.before ? found->second : i;
      *to = old[static_cast<std::size_t>(o.previous.element[kType]) + from];
      for (int& v : to->v) v += o.at.vertex - o.previous.vertex;
      if (o.before) redefine(*to, models[i]);
    }
  }
}

void placeAttachments(HostTables& tables, const std::vector<EngineAttachment>& attachments) {
  SolverData& s = tables.view();
  const std::vector<Attachment> old = copyOf(s.attachment, s.attachments);
  tables.reserve(Per::Attachment, static_cast<int>(attachments.size()));
  s.attachments = static_cast<int>(attachments.size());
  for (std::size_t i = 0; i < attachments.size(); ++i) {
    Attachment& to = s.attachment[i];
    to = made(attachments[i]);
    if (attachments[i].previous < 0) continue;
    Attachment kept = old[static_cast<std::size_t>(attachments[i].previous)];
    std::ranges::copy(to.v, kept.v);
    kept.body = to.body, kept.mass = to.mass, kept.length = to.length;
    kept.worldPoint = to.worldPoint, kept.anchor = to.anchor;
    kept.bound = to.bound, kept.compliance = to.compliance;
    to = kept;
  }
}

/// Persistent state of vertices by old index.
struct OldVertices {
  explicit OldVertices(const SolverData& s)
      : position(copyOf(s.vertexPosition, s.vertices)),
        velocity(copyOf(s.vertexVelocity, s.vertices)),
        oldVelocity(copyOf(s.vertexOldVelocity, s.vertices)),
        force(copyOf(s.vertexForce, s.vertices)),
        color(copyOf(s.vertexColor, s.vertices)),
        offset(copyOf(s.oldPointPairOffset, s.owners() + 1)),
        pair(copyOf(s.oldPointPair, offset.back())),
        contact(copyOf(s.oldPointContact, offset.back())),
        edges(s.edges),
        features(s.features) {}
  std::vector<Vec3d> position;
  std::vector<Vec3> velocity, oldVelocity, force;
  std::vector<int> color, offset;
  std::vector<PointPair> pair;
  std::vector<PointContact> contact;
  int edges, features;
};

/// Old index of each new vertex and feature, and new index of each old one. -1: none.
struct Moves {
  std::vector<int> vertexFrom, vertexTo, featureFrom, featureTo;

  void addFeatures(const SolverData& s, const OldVertices& old,
                   const std::vector<EngineSoftObject>& objects) {
    featureFrom.assign(static_cast<std::size_t>(s.features), -1);
    featureTo.assign(static_cast<std::size_t>(old.features), -1);
    const auto link = [&](int from, int to) {
      featureFrom[static_cast<std::size_t>(to)] = from, featureTo[static_cast<std::size_t>(from)] = to;
    };
    // of a redefined object those with the same corners; contacts of others are lost
    const auto add = [&]<class T>(const std::vector<T>* before, const std::vector<T>& now, int from, int to) {
      std::map<decltype(T::v), int> indices;
      for (std::size_t k = 0; before && k < before->size(); ++k)
        indices.emplace((*before)[k].v, static_cast<int>(k));
      for (int k = 0; k < static_cast<int>(now.size()); ++k) {
        const auto found = indices.find(now[static_cast<std::size_t>(k)].v);
        if (!before || found != indices.end()) link(from + (before ? found->second : k), to + k);
      }
    };
    for (const EngineSoftObject& o : objects) {
      if (o.previous.vertex < 0) continue;
      const SoftModel* const before = o.before ? &*o.before : nullptr;
      add(before ? &before->edges : nullptr, o.model->edges, o.previous.edge, o.at.edge);
      add(before ? &before->faces : nullptr, o.model->faces, old.edges + o.previous.face,
          s.edges + o.at.face);
    }
  }
  /// Old index of an owner of pairs.
  int ownerFrom(const SolverData& s, const OldVertices& old, int owner) const {
    if (owner < s.vertices) return vertexFrom[static_cast<std::size_t>(owner)];
    if (owner >= s.vertices + s.edges) {
      const int from = owner - s.vertices - s.edges + static_cast<int>(old.position.size()) + old.edges;
      return from < static_cast<int>(old.offset.size()) - 1 ? from : -1;
    }
    const int from = featureFrom[static_cast<std::size_t>(owner - s.vertices)];
    return from < 0 ? -1 : static_cast<int>(old.position.size()) + from;
  }
  /// New code of the partner of a pair. Bodies are unchanged. Below -1: removed.
  int partnerTo(int other) const {
    const auto moved = [&](int base, const std::vector<int>& to) {
      const int now = to[static_cast<std::size_t>(other - base)];
      return now < 0 ? kGone : base + now;
    };
    if (other >= kFeatureNode) return moved(kFeatureNode, featureTo);
    if (other >= kCornerNode) return moved(kCornerNode, vertexTo);
    return other >= kVertexNode ? moved(kVertexNode, vertexTo) : other;
  }
  static constexpr int kGone = -2;
};

/// Keeps the contacts of the last step between vertices that still exist.
void placeContacts(HostTables& tables, const OldVertices& old, const Moves& moves) {
  tables.reserve(Per::PointPair, static_cast<int>(old.pair.size()));
  SolverData& s = tables.view();
  int n = 0;
  for (int owner = 0; owner < s.owners(); ++owner) {
    s.oldPointPairOffset[owner] = n;
    const int from = moves.ownerFrom(s, old, owner);
    if (from < 0) continue;
    for (int k = old.offset[static_cast<std::size_t>(from)];
         k < old.offset[static_cast<std::size_t>(from) + 1]; ++k) {
      PointPair pair = old.pair[static_cast<std::size_t>(k)];
      PointContact contact = old.contact[static_cast<std::size_t>(k)];
      pair.vertex = owner;
      pair.other = moves.partnerTo(pair.other);
      if (pair.other == Moves::kGone) continue;
      for (int& corner : contact.v)
        if (corner >= 0) corner = moves.vertexTo[static_cast<std::size_t>(corner)];
      s.oldPointPair[n] = pair;
      s.oldPointContact[n++] = contact;
    }
  }
  s.oldPointPairOffset[s.owners()] = n;
}

void reserveVertices(HostTables& tables, int vertices) {
  if (vertices == 0) return;
  tables.reserve(Per::Vertex, vertices);
  tables.reserve(Per::Node, tables.capacity(Per::Body) + tables.capacity(Per::Vertex));
}

void placeSoft(HostTables& tables, const std::vector<EngineSoftObject>& objects,
               const std::vector<EngineAttachment>& attachments) {
  SolverData& s = tables.view();
  const OldVertices old(s);
  int vertices = 0;
  for (const EngineSoftObject& o : objects) vertices += static_cast<int>(o.model->vertices.size());
  reserveVertices(tables, vertices);
  Moves moves;
  moves.vertexFrom.assign(static_cast<std::size_t>(vertices), -1),
      moves.vertexTo.assign(old.position.size(), -1);
  s.vertices = vertices;
  Real widest = 0;
  for (const EngineSoftObject& o : objects) {
    const SoftModel& m = *o.model;
    const int inside = m.collides & ~(kCollidesWithSurfaces | kCollidesWithSelf),
              onSurface = o.hasPartner ? m.collides : m.collides & ~kCollidesWithSurfaces;
    double meanLength = 0;
    for (const SoftModel::Vertex& in : m.vertices)
      meanLength += in.length / static_cast<double>(m.vertices.size());
    for (std::size_t i = 0; i < m.vertices.size(); ++i) {
      const SoftModel::Vertex& in = m.vertices[i];
      const int v = o.at.vertex + static_cast<int>(i);
      VertexParams& p = s.vertexParams[v];
      p.kind = in.mass > 0 ? VertexKind::Dynamic : VertexKind::Fixed;
      p.mass = real(in.mass), p.radius = real(in.radius), p.length = real(in.length);
      p.muStatic = real(m.material.staticFriction), p.muDynamic = real(m.material.dynamicFriction);
      p.restitution = real(m.material.restitution);
      p.frictionCombine = static_cast<std::uint32_t>(m.material.frictionCombine) & 0xffu;
      p.materialKind = o.surface < 0 ? 0 : s.surface[o.surface].kind;
      p.restitutionCombine = static_cast<int>(m.material.restitutionCombine);
      p.gravityScale = real(m.gravityScale);
      p.first = o.at.vertex, p.collides = in.onSurface ? onSurface : inside;
      p.surfaceRadius = real(m.surfaceRadius);
      s.vertexRest[v] = Vec3(in.rest);
      p.cluster = p.softNode = -1, p.reach = real(meanLength);
      if (p.collides & kCollidesWithParticles) widest = max(widest, p.radius);
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
      if (o.before && p.kind == VertexKind::Fixed) s.vertexVelocity[v] = s.vertexOldVelocity[v] = {0, 0, 0};
      moves.vertexFrom[static_cast<std::size_t>(v)] = static_cast<int>(from);
      moves.vertexTo[from] = v;
    }
  }
  // cells are slightly wider than the largest particle
  // a number that SoftCounts holds without loss
  s.particleCell = widest > Real(0) ? real(static_cast<float>(Real(2.2) * widest)) : Real(1);
  s.particleCells = widest > Real(0)
                        ? static_cast<int>(std::bit_ceil(static_cast<unsigned>(std::max(64, 2 * vertices))))
                        : 0;
  tables.reserve(Per::ParticleCell, s.particleCells);
  forEachType(ElementTypes{}, [&]<class F>() { placeElements<F>(tables, objects); });
  countYielding(s);
  placeAttachments(tables, attachments);
  connect(tables);
  placeClusters(tables, objects);
  placeSoftNodes(tables, objects);
  placeStrands(tables, objects);
  placeFeatures(tables, objects);
  moves.addFeatures(s, old, objects);
  placeContacts(tables, old, moves);
}

}  // namespace

void setSoft(HostTables& tables, const std::vector<EngineSoftObject>& objects,
             const std::vector<EngineAttachment>& attachments) {
  const SoftBackup backup(tables);
  try {
    placeSoft(tables, objects, attachments);
  } catch (const std::bad_alloc&) {
    backup.restore(tables);
    throw;
  }
}

void countYielding(SolverData& s) {
  const std::span<const Tetrahedron> all(
      s.elementsOf<Tetrahedron>(),
      static_cast<std::size_t>(s.elements[typeIndex<Tetrahedron>(ElementTypes{})]));
  s.yielding = static_cast<int>(
      std::count_if(all.begin(), all.end(), [](const Tetrahedron& e) { return e.yield < kUnreached; }));
}

SoftCounts softCounts(const SolverData& s) {
  SoftCounts c{s.vertices,
               s.refOffset[s.vertices],
               s.tetraCornerOffset[s.vertices],
               s.neighborOffset[s.vertices],
               s.particleCells,
               s.attachments,
               {},
               {},
               s.movingParts,
               s.clusterRefs,
               s.softNodes,
               s.objects,
               s.strands,
               s.strandVertices,
               static_cast<float>(s.particleCell),
               s.edges,
               s.features,
               s.featureCells,
               static_cast<float>(s.featureCell)};
  std::copy(std::begin(s.clusterBegin), std::end(s.clusterBegin), c.clusterBegin);
  std::copy(std::begin(s.elements), std::end(s.elements), c.elements);
  return c;
}

void reserveSoft(HostTables& tables, const SoftCounts& c, int bodies) {
  reserveVertices(tables, c.vertices);
  tables.reserve(Per::ElementRef, c.refs);
  tables.reserve(Per::TetraCorner, c.tetraCorners);
  tables.reserve(Per::Neighbor, c.neighbors);
  tables.reserve(Per::ParticleCell, c.particleCells);
  tables.reserve(Per::Attachment, c.attachments);
  tables.reserve(Per::Cluster, c.clusterBegin[kClusterLevels]);
  tables.reserve(Per::ClusterRef, c.clusterRefs);
  tables.reserve(Per::SoftNode, c.softNodes);
  tables.reserve(Per::Strand, c.lines);
  tables.reserve(Per::StrandVertex, c.strandVertices);
  reserveNodes(tables);
  forEachType(ElementTypes{},
              [&]<class F>() { tables.reserve(perElement<F>(), c.elements[typeIndex<F>(ElementTypes{})]); });
  SolverData then = tables.view();
  then.bodies = bodies, then.vertices = c.vertices, then.edges = c.edges;
  then.features = c.features, then.featureCells = c.featureCells;
  reserveFeatures(tables, then);
}

void setSoftCounts(HostTables& tables, const SoftCounts& c) {
  SolverData& s = tables.view();
  s.vertices = c.vertices, s.particleCells = c.particleCells, s.attachments = c.attachments;
  s.particleCell = real(c.particleCell);
  s.edges = c.edges, s.features = c.features, s.featureCells = c.featureCells;
  s.featureCell = real(c.featureCell);
  s.movingParts = c.movingParts, s.clusterRefs = c.clusterRefs;
  s.softNodes = c.softNodes, s.objects = c.objects;
  s.strands = c.lines, s.strandVertices = c.strandVertices;
  std::copy(std::begin(c.clusterBegin), std::end(c.clusterBegin), s.clusterBegin);
  s.refOffset[c.vertices] = c.refs;
  s.tetraCornerOffset[c.vertices] = c.tetraCorners;
  s.neighborOffset[c.vertices] = c.neighbors;
  std::copy(std::begin(c.elements), std::end(c.elements), s.elements);
}

void setVertexStates(HostTables& tables, int first, std::span<const rubble::Vec3> positions,
                     std::span<const rubble::Vec3> velocities) {
  SolverData& s = tables.view();
  for (std::size_t i = 0; i < positions.size(); ++i)
    s.vertexPosition[static_cast<std::size_t>(first) + i] = positions[i];
  for (std::size_t i = 0; i < velocities.size(); ++i) {
    const std::size_t v = static_cast<std::size_t>(first) + i;
    if (s.vertexParams[v].kind == VertexKind::Dynamic)
      s.vertexVelocity[v] = s.vertexOldVelocity[v] = Vec3(velocities[i]);
  }
}

void forgetVertexContacts(HostTables& tables, int body) {
  SolverData& s = tables.view();
  for (int k = 0; k < s.oldPointPairOffset[s.owners()]; ++k)
    if (s.oldPointPair[k].other == body || (s.oldPointPair[k].vertex >= s.vertices + s.edges &&
                                            bodyOfOwner(s, s.oldPointPair[k].vertex) == body)) {
      s.oldPointPair[k].other = -1;
      s.oldPointContact[k].active = 0;
    }
}

}  // namespace rubble::RUBBLE_CORE
