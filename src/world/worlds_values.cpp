/// Authored values of many worlds at once.
#include <algorithm>
#include <exception>
#include <functional>
#include <memory>
#include <variant>

#include "cook/checks.h"
#include "world/body_additions.h"
#include "world/value_path.h"
#include "world/worlds_impl.h"

namespace rubble {

namespace {

/// Makes a change that can be made.
using Commit = std::function<void()>;

struct OfGravity {};
struct OfActuator {
  std::shared_ptr<ActuatorState> state;
  std::size_t world, place;
};
/// What a path names in a world.
using Named = std::variant<OfGravity, BodyId, JointId, DeformableId, AttachmentId, MaterialPair, OfActuator>;

/// A path, and the keys of its value in a definition.
struct ValueRequest {
  ValuePath path;
  std::vector<PathPart> keys;

  explicit ValueRequest(const std::string& text) : path(text) {
    const std::string& list = path.list();
    const auto name = [&](std::size_t names) {
      if (path.size() < names + 1)
        throw Error("path", names > 1 ? "two names and a key" : "a name and a key", "\"" + text + "\"");
      const std::span<const PathPart> own = path.keys(names);
      keys.assign(own.begin(), own.end());
    };
    if (list == "materials") {
      name(1);
      keys.insert(keys.begin(), PathPart{"material"});
    } else if (list == "material_pairs") {
      name(2);
    } else if (list == "bodies" || list == "joints" || list == "deformables" || list == "attachments" ||
               list == "actuators") {
      name(1);
    } else if (list != "gravity") {
      fail();
    } else if (path.size() > 0) {
      throw Error("path", "no key after gravity", "\"" + text + "\"");
    }
  }

 private:
  [[noreturn]] void fail() const {
    const std::string& list = path.list();
    const auto isParameter = [&](const ParamField& field) { return std::string_view(field.name) == list; };
    if (std::ranges::any_of(paramFields(), isParameter))
      throw Error("path", "a value that worlds have of their own; setParams() sets parameters of all worlds",
                  "\"" + list + "\"");
    throw Error("path",
                "gravity, bodies, joints, deformables, attachments, actuators, materials or material_pairs",
                "\"" + list + "\"");
  }
};

/// The values of one path in one world. Own: World::Impl, which only friends name.
template <class Own> class WorldValues {
 public:
  WorldValues(World& world, Own& own, const ValueRequest& asked)
      : world_(world), own_(own), path_(asked.path), keys_(asked.keys) {}

  /// Throws Error if there is nothing of that name.
  std::vector<Named> named() const {
    const std::string& list = path_.list();
    if (list == "gravity") return {OfGravity{}};
    const PathPart& name = path_.part(0);
    if (list == "bodies") return {idOf(name, &World::bodies, &World::findBody)};
    if (list == "joints") return {idOf(name, &World::joints, &World::findJoint)};
    if (list == "deformables") return {idOf(name, &World::deformables, &World::findDeformable)};
    if (list == "attachments") return {attachment(name)};
    if (list == "actuators") return {actuator(name)};
    return list == "materials" ? ofMaterial(name.text) : std::vector<Named>{pair()};
  }

  Commit change(const Named& what, std::span<const double> numbers) const {
    return std::visit([&](const auto& target) { return changeOf(target, numbers); }, what);
  }
  void read(const Named& what, std::vector<double>& to) const {
    std::visit([&](const auto& target) { readOf(target, to); }, what);
  }

 private:
  auto idOf(const PathPart& name, auto list, auto find) const {
    if (!name.isPlace) return (world_.*find)(name.text);
    const auto ids = (world_.*list)();
    return ids[within(name, ids.size())];
  }
  static std::size_t within(const PathPart& place, std::size_t count) {
    if (static_cast<std::size_t>(place.index) >= count)
      throw Error("path", "a place below " + std::to_string(count), place.text);
    return static_cast<std::size_t>(place.index);
  }
  Named attachment(const PathPart& name) const {
    const std::vector<AttachmentId> ids = world_.attachments();
    if (name.isPlace) return ids[within(name, ids.size())];
    for (const AttachmentId id : ids)
      if (own_.registry.attachments[id].def.name == name.text) return id;
    throw Error("attachment", "the name of an attachment", "\"" + name.text + "\"");
  }
  Named actuator(const PathPart& name) const {
    for (const auto& [held, world] : own_.actuators) {
      std::shared_ptr<ActuatorState> state = held.lock();
      if (!state) continue;
      const std::vector<ActuatorDef>& all = *state->definitions[world];
      if (name.isPlace) return OfActuator{state, world, within(name, all.size())};
      const auto found = std::ranges::find(all, name.text, &ActuatorDef::name);
      if (found != all.end()) return OfActuator{state, world, static_cast<std::size_t>(found - all.begin())};
    }
    throw Error("actuator", "the name of one of the Actuators of these worlds", "\"" + name.text + "\"");
  }
  std::vector<Named> ofMaterial(const std::string& name) const {
    std::vector<Named> all;
    for (const BodyId id : world_.bodies())
      if (world_.definition(id).material.name == name) all.emplace_back(id);
    for (const DeformableId id : world_.deformables())
      if (common(world_.definition(id)).material.name == name) all.emplace_back(id);
    if (all.empty())
      throw Error("material", "the name of the material of a body or object", "\"" + name + "\"");
    return all;
  }
  MaterialPair pair() const {
    const MaterialPair names{path_.part(0).text, path_.part(1).text};
    for (const MaterialPair& pair : world_.materialPairs())
      if (ofSameMaterials(pair, names)) return pair;
    throw Error("material_pairs", "two names that have a rule",
                "\"" + names.a + "\" and \"" + names.b + "\"");
  }

  Commit changeOf(OfGravity, std::span<const double> numbers) const {
    if (numbers.size() != 3)
      throw Error("values", "3 for gravity in each world", std::to_string(numbers.size()));
    const Vec3 gravity{numbers[0], numbers[1], numbers[2]};
    checks::finite(gravity, "gravity");
    return [&world = world_, gravity] { world.setGravity(gravity); };
  }
  Commit changeOf(BodyId id, std::span<const double> numbers) const {
    BodyDef def = world_.definition(id);
    if (isBodyState(keys_)) {
      BodyState state = world_.state(id);
      takeState(state, def);
      placeIn(def, keys_).set(numbers);
      state = {def.position, def.orientation, def.velocity, def.angularVelocity};
      validate(state, "body");
      return [&world = world_, id, state] { world.setState(id, state); };
    }
    placeIn(def, keys_).set(numbers);
    const auto ready = std::make_shared<BodyChange>(own_.redefined(id, std::move(def)));
    return [&own = own_, ready] { own.apply(std::move(*ready)); };
  }
  Commit changeOf(JointId id, std::span<const double> numbers) const {
    JointDef def = world_.definition(id);
    placeIn(def, keys_).set(numbers);
    EngineJoint joint = own_.redefined(id, def);
    return [&own = own_, id, def = std::move(def), joint = std::move(joint)] { own.apply(id, def, joint); };
  }
  Commit changeOf(DeformableId id, std::span<const double> numbers) const {
    Deformable def = world_.definition(id);
    placeIn(def, keys_).set(numbers);
    return [&own = own_, id, ready = own_.redefined(id, def)] { own.apply(id, ready); };
  }
  Commit changeOf(AttachmentId id, std::span<const double> numbers) const {
    AttachmentRecord record = own_.registry.attachments[id];
    if (!record.def.anchor) record.def.anchor = record.anchor;
    placeIn(record.def, keys_).set(numbers);
    checkNumbers(record.def, "attachment");
    record.anchor = *record.def.anchor;
    return [&own = own_, id, record] {
      own.registry.attachments.prepare(0);
      own.registry.attachments.edit(id) = record;
      own.softChanged = true;
    };
  }
  Commit changeOf(MaterialPair pair, std::span<const double> numbers) const {
    placeIn(pair, keys_).set(numbers);
    validate(pair, "material_pairs");
    return [&world = world_, pair] { world.setMaterialPair(pair); };
  }
  Commit changeOf(const OfActuator& of, std::span<const double> numbers) const {
    if (keys_.front().text == "control" || keys_.front().text == "activation")
      throw Error("path", "a value that lasts; Actuators have arrays of controls and activations",
                  keys_.front().text);
    auto all = std::make_shared<std::vector<ActuatorDef>>(*of.state->definitions[of.world]);
    placeIn((*all)[of.place], keys_).set(numbers);
    validate((*all)[of.place], "actuator");
    return [of, all] { of.state->definitions[of.world] = all; };
  }

  void readOf(OfGravity, std::vector<double>& to) const {
    const Vec3 g = world_.gravity();
    to.insert(to.end(), {g.x, g.y, g.z});
  }
  void readOf(BodyId id, std::vector<double>& to) const {
    BodyDef def = world_.definition(id);
    def.mass = world_.massOf(id).mass;
    if (isBodyState(keys_)) takeState(world_.state(id), def);
    placeIn(def, keys_).get(to);
  }
  void readOf(JointId id, std::vector<double>& to) const {
    JointDef def = world_.definition(id);
    placeIn(def, keys_).get(to);
  }
  void readOf(DeformableId id, std::vector<double>& to) const {
    Deformable def = world_.definition(id);
    placeIn(def, keys_).get(to);
  }
  void readOf(AttachmentId id, std::vector<double>& to) const {
    AttachmentDef def = own_.registry.attachments[id].def;
    def.anchor = own_.registry.attachments[id].anchor;
    placeIn(def, keys_).get(to);
  }
  void readOf(MaterialPair pair, std::vector<double>& to) const { placeIn(pair, keys_).get(to); }
  void readOf(const OfActuator& of, std::vector<double>& to) const {
    ActuatorDef def = (*of.state->definitions[of.world])[of.place];
    placeIn(def, keys_).get(to);
  }

  static void takeState(const BodyState& state, BodyDef& to) {
    to.position = state.position, to.orientation = state.orientation;
    to.velocity = state.velocity, to.angularVelocity = state.angularVelocity;
  }

  World& world_;
  Own& own_;
  const ValuePath& path_;
  std::span<const PathPart> keys_;
};

/// Calls f(); an Error gets the number of the world.
template <class F> decltype(auto) inWorld(int world, F&& f) try { return f(); } catch (const OutOfMemory&) {
  throw;
} catch (const Error& error) {
  if (error.path().empty()) throw;
  const std::string path = "worlds[" + std::to_string(world) + "]." + error.path();
  throw Error(path, error.expected(), error.found());
}

}  // namespace

void Worlds::setValues(const std::string& path, std::span<const int> worlds, std::span<const double> values) {
  const ValueRequest asked(path);
  impl_->requireDistinct(worlds);
  if (worlds.empty()) return;
  if (values.empty() || values.size() % worlds.size() != 0)
    throw Error("values", "as many numbers for each of " + std::to_string(worlds.size()) + " worlds",
                std::to_string(values.size()));
  const std::size_t width = values.size() / worlds.size();
  // Objects of one world follow one another, since the second change begins where the first one ends.
  std::vector<std::vector<Named>> named(worlds.size());
  std::vector<std::vector<std::size_t>> ofBatch(impl_->batches.size());
  std::size_t rounds = 0;
  const auto valuesOf = [&](std::size_t k) {
    return WorldValues((*this)[worlds[k]], impl_->at(worlds[k]), asked);
  };
  for (std::size_t k = 0; k < worlds.size(); ++k) {
    named[k] = inWorld(worlds[k], [&] { return valuesOf(k).named(); });
    rounds = std::max(rounds, named[k].size());
    ofBatch[static_cast<std::size_t>(worlds[k] / impl_->perBatch)].push_back(k);
  }
  const auto prepare = [&](std::size_t round) {
    std::vector<Commit> commits(worlds.size());
    std::vector<std::pair<std::size_t, std::exception_ptr>> failures(ofBatch.size());
    const auto ofOne = [&](std::size_t batch) {
      for (const std::size_t k : ofBatch[batch]) {
        if (round >= named[k].size()) continue;
        try {
          commits[k] = inWorld(worlds[k], [&] {
            return valuesOf(k).change(named[k][round], values.subspan(k * width, width));
          });
        } catch (...) {
          failures[batch] = {k, std::current_exception()};
          return;
        }
      }
    };
    // shapes are cooked in one place for all worlds
    if (asked.keys.size() > 0 && asked.keys[0].text == "shape")
      for (std::size_t batch = 0; batch < ofBatch.size(); ++batch) ofOne(batch);
    else
      impl_->forEachBatch(ofOne);
    std::erase_if(failures, [](const auto& each) { return !each.second; });
    if (!failures.empty())
      std::rethrow_exception(
          std::ranges::min_element(failures, {}, &std::pair<std::size_t, std::exception_ptr>::first)->second);
    return commits;
  };
  for (std::size_t round = 0; rounds > 1 && round < rounds; ++round)
    prepare(round);  // throws, or does nothing
  for (std::size_t round = 0; round < rounds; ++round) {
    std::vector<Commit> commits = prepare(round);
    impl_->forEachBatch([&](std::size_t batch) {
      for (const std::size_t k : ofBatch[batch])
        if (commits[k]) commits[k]();
    });
  }
}

std::vector<double> Worlds::values(const std::string& path, std::span<const int> worlds) const {
  const ValueRequest asked(path);
  std::vector<double> out;
  for (const int world : worlds) {
    impl_->requireWorld(world);
    inWorld(world, [&] {
      const WorldValues own(impl_->worlds[static_cast<std::size_t>(world)], impl_->at(world), asked);
      own.read(own.named().front(), out);
    });
  }
  return out;
}

}  // namespace rubble
