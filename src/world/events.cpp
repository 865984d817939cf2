/// Events of a step, from the state of the engine after it and the state recorded before.
#include <algorithm>

#include <rubble/world.h>

#include "world/world_impl.h"

namespace rubble {

namespace {

bool before(const Touch& s, const Touch& t) {
  return std::pair(s.a.index, s.b.index) < std::pair(t.a.index, t.b.index);
}
bool same(const Touch& s, const Touch& t) { return s.a == t.a && s.b == t.b; }

}  // namespace

std::vector<Touch> World::Impl::collectContacts(Events& to) const {
  std::vector<Touch> now;
  for (const EngineTouch& t : engine->read().touches()) {
    const auto a = registry.bodies.at(t.a), b = registry.bodies.at(t.b);
    if (!a || !b) continue;
    const BodyDef &first = registry.bodies[*a].def, &second = registry.bodies[*b].def;
    now.push_back(
        {*a, *b, t.sensor, first.userData, second.userData, first.shape.userData, second.shape.userData});
  }
  std::sort(now.begin(), now.end(), before);
  // two bodies may touch at several of their parts
  now.erase(std::unique(now.begin(), now.end(), same), now.end());
  std::vector<EngineContact> points = engine->read().contacts();
  std::stable_sort(points.begin(), points.end(), [](const EngineContact& p, const EngineContact& q) {
    return std::pair(p.a, p.b) < std::pair(q.a, q.b);
  });

  const auto add = [&](Phase phase, const Touch& touch) {
    ContactEvent& event = to.contacts.emplace_back();
    event.phase = phase;
    event.a = touch.a, event.b = touch.b;
    event.userDataA = touch.userDataA, event.userDataB = touch.userDataB;
    event.shapeUserDataA = touch.shapeUserDataA, event.shapeUserDataB = touch.shapeUserDataB;
    event.sensor = touch.sensor;
    if (phase == Phase::End || touch.sensor) return;
    const auto key = std::pair(touch.a.index, touch.b.index);
    auto p = std::lower_bound(points.begin(), points.end(), key,
                              [](const EngineContact& c, const auto& k) { return std::pair(c.a, c.b) < k; });
    for (; p != points.end() && std::pair(p->a, p->b) == key; ++p) {
      event.points.push_back(
          {touch.a, touch.b, p->position, p->normal, p->depth, p->force, p->partA, p->partB});
      event.impulse += p->force * params.dt;
    }
  };
  // merge of two sorted lists; a reused slot counts as another pair
  const std::vector<Touch>& old = registry.touches;
  std::size_t i = 0, k = 0;
  while (i < old.size() || k < now.size()) {
    if (k == now.size() || (i < old.size() && before(old[i], now[k]))) {
      add(Phase::End, old[i++]);
    } else if (i == old.size() || before(now[k], old[i])) {
      add(Phase::Begin, now[k++]);
    } else if (same(old[i], now[k])) {
      add(Phase::Stay, now[k++]), ++i;
    } else {
      add(Phase::End, old[i++]);
      add(Phase::Begin, now[k++]);
    }
  }
  return now;
}

void World::Impl::collectBreaks(Events& to, std::span<const JointId> broken) const {
  for (const JointId id : broken) {
    const JointRecord& joint = registry.joints[id];
    const JointState state = engine->read().jointState(static_cast<int>(joint.engine.type), joint.engineSlot);
    to.joints.push_back({id, joint.def.userData, joint.a, joint.b, state.force, state.torque});
  }
}

std::vector<int> World::Impl::collectSleeps(Events& to) const {
  std::vector<int> now = engine->read().sleepers();
  const std::vector<int>& old = registry.sleepers;
  std::size_t i = 0, k = 0;
  const auto add = [&](int slot, bool asleep) {
    if (const auto id = registry.bodies.at(slot))
      to.sleeps.push_back({*id, asleep, registry.bodies[*id].def.userData});
  };
  while (i < old.size() || k < now.size()) {
    if (k == now.size() || (i < old.size() && old[i] < now[k]))
      add(old[i++], false);
    else if (i == old.size() || now[k] < old[i])
      add(now[k++], true);
    else
      ++i, ++k;
  }
  return now;
}

void World::Impl::collectEvents(std::span<const JointId> broken) {
  Events fresh;
  std::vector<Touch> touches = collectContacts(fresh);
  collectBreaks(fresh, broken);
  std::vector<int> sleepers;
  if (params.sleeping || !registry.sleepers.empty()) sleepers = collectSleeps(fresh);
  // all of it or, without memory, nothing: the next step then reports what has changed since the last events
  events = std::move(fresh);
  registry.touches = std::move(touches);
  registry.sleepers = std::move(sleepers);
}

const Events& World::events() const {
  impl_->idle.events.seen |= !impl_->wantsEvents;
  return impl_->events;
}

bool World::asleep(BodyId id) const {
  impl_->requireAlive(id);
  return impl_->params.sleeping && impl_->engine->read(Fetch::Body, id.index).isAsleep(id.index);
}

void World::wake(BodyId id) {
  impl_->requireAlive(id);
  withMemory("wake", [&] {
    std::vector<Edit> edits;
    impl_->addWake(edits, id);
    impl_->engine->apply(edits);
  });
  impl_->pass(inputs::Wake{id});
}

void World::Impl::addWake(std::vector<Edit>& edits, BodyId id) {
  if (!params.sleeping || id.index < 0) return;
  if (registry.bodies[id].def.motion == Motion::Dynamic)
    edits.push_back(SetBodyState{id.index, bodyState(id)});
  else
    edits.push_back(ForgetContacts{{id.index}});
}

std::vector<ContactPoint> World::contacts() const {
  return withMemory("contacts", [&] {
    std::vector<ContactPoint> out;
    for (const EngineContact& c : impl_->engine->read().contacts()) {
      const auto a = impl_->registry.bodies.at(c.a), b = impl_->registry.bodies.at(c.b);
      if (a && b) out.push_back({*a, *b, c.position, c.normal, c.depth, c.force, c.partA, c.partB});
    }
    return out;
  });
}

std::vector<SolverState> World::solverStates() const {
  return withMemory("solverStates", [&] {
    const std::vector<SolverState> all = impl_->engine->read().bodySolverStates();
    std::vector<SolverState> out;
    for (const BodyId id : bodies()) out.push_back(all[static_cast<std::size_t>(id.index)]);
    return out;
  });
}

std::vector<SolverState> World::solverStates(DeformableId id) const {
  return withMemory("solverStates", [&] {
    impl_->requireAlive(id);
    impl_->flush();
    const SoftRange& range = impl_->registry.softs[id].range;
    const std::vector<SolverState> all = impl_->engine->read().vertexSolverStates();
    const auto first = all.begin() + range.vertex;
    return std::vector<SolverState>(first, first + vertexCount(id));
  });
}

ContactLoad World::contactLoad(BodyId id) const {
  return withMemory("contactLoad", [&] {
    impl_->requireAlive(id);
    const Vec3 center = impl_->bodyState(id).position;
    ContactLoad load;
    for (const EngineContact& c : impl_->engine->read().contacts()) {
      if (c.a != id.index && c.b != id.index) continue;
      const Vec3 force = c.b == id.index ? c.force : -c.force;
      load.force += force;
      load.torque += cross(c.position - center, force);
      load.residual = std::max(load.residual, c.depth);
      ++load.points;
    }
    return load;
  });
}

}  // namespace rubble
