#include "backend/ordered_engine.h"

#include <algorithm>

namespace rubble {

std::vector<int> OrderedEngine::slots(std::span<const int> ids) const {
  std::vector<int> out;
  out.reserve(ids.size());
  for (const int id : ids) out.push_back(slot(id));
  return out;
}

EngineJoint OrderedEngine::inSlots(EngineJoint joint) const {
  joint.a = slot(joint.a), joint.b = slot(joint.b);
  joint.carrierA = slot(joint.carrierA), joint.carrierB = slot(joint.carrierB);
  return joint;
}

std::vector<EngineQuery> OrderedEngine::inSlots(std::span<const EngineQuery> queries) const {
  std::vector<EngineQuery> out(queries.begin(), queries.end());
  for (EngineQuery& q : out) q.ignore = slot(q.ignore);
  return out;
}

void OrderedEngine::setSoft(const std::vector<EngineSoftObject>& objects,
                            const std::vector<EngineAttachment>& attachments) {
  std::vector<EngineAttachment> own = attachments;
  for (EngineAttachment& a : own) a.body = slot(a.body);
  engine_->setSoft(objects, own);
}

std::vector<int> OrderedEngine::sleepers() const {
  std::vector<int> out = engine_->sleepers();
  for (int& body : out) body = idOf(body);
  std::sort(out.begin(), out.end());
  return out;
}

void OrderedEngine::solverStates(std::vector<SolverState>& bodies, std::vector<SolverState>& vertices) const {
  std::vector<SolverState> bySlot;
  engine_->solverStates(bySlot, vertices);
  bodies.resize(bySlot.size());
  for (std::size_t k = 0; k < bySlot.size(); ++k)
    bodies[static_cast<std::size_t>(idOf(static_cast<int>(k)))] = bySlot[k];
}

std::vector<EngineContact> OrderedEngine::contacts() const {
  std::vector<EngineContact> out = engine_->contacts();
  for (EngineContact& c : out) c.a = idOf(c.a), c.b = idOf(c.b);
  return out;
}

std::vector<EngineTouch> OrderedEngine::touches() const {
  std::vector<EngineTouch> out = engine_->touches();
  for (EngineTouch& t : out) t.a = idOf(t.a), t.b = idOf(t.b);
  return out;
}

std::vector<EngineVertexContact> OrderedEngine::vertexContacts() const {
  std::vector<EngineVertexContact> out = engine_->vertexContacts();
  for (EngineVertexContact& c : out) c.body = idOf(c.body);
  return out;
}

std::vector<EngineHit> OrderedEngine::query(std::span<const EngineQuery> queries) {
  std::vector<EngineHit> out = engine_->query(inSlots(queries));
  for (EngineHit& hit : out) hit.body = idOf(hit.body);
  return out;
}

std::vector<std::vector<int>> OrderedEngine::overlaps(std::span<const EngineQuery> queries) {
  std::vector<std::vector<int>> out = engine_->overlaps(inSlots(queries));
  for (std::vector<int>& bodies : out) {
    for (int& body : bodies) body = idOf(body);
    std::sort(bodies.begin(), bodies.end());
  }
  return out;
}

void OrderedEngine::step(StepReport& report) {
  report.sorted = std::exchange(due_, false) || (sortInterval_ > 0 && report.step % sortInterval_ == 0);
  if (report.sorted) engine_->sortBodies();
  engine_->step(report);
}

}  // namespace rubble
