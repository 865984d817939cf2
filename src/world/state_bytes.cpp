/// The state of a world as bytes: a head, then the state of the engine.
#include <algorithm>
#include <cstring>

#include "world/world_impl.h"

namespace rubble {

namespace {

/// Changes with every change of the tables.
constexpr std::uint32_t kStateVersion = 1;

struct StateHead {
  char magic[8] = {'R', 'u', 'b', 'b', 'l', 'e', 'S', 't'};
  std::uint32_t version = kStateVersion, doublePrecision = 0;
  std::int64_t step = 0;
  double time = 0;
  std::int32_t bodies = 0, joints = 0, deformables = 0, attachments = 0;  ///< slots
  std::uint64_t size = 0, hash = 0;                                       ///< of the state of the engine
};

StateHead headOf(std::span<const std::byte> bytes) {
  StateHead head;
  const StateHead expected;
  if (bytes.size() >= sizeof head) std::memcpy(&head, bytes.data(), sizeof head);
  if (bytes.size() < sizeof head || std::memcmp(head.magic, expected.magic, sizeof head.magic) != 0)
    throw Error("state", "bytes of World::stateBytes()", "others");
  if (head.version != kStateVersion)
    throw Error("state", "version " + std::to_string(kStateVersion), std::to_string(head.version));
  const std::span<const std::byte> engine = bytes.subspan(sizeof head);
  if (engine.size() != head.size || hashOf(engine) != head.hash)
    throw Error("state", "all bytes as they were written", "damaged ones");
  return head;
}

}  // namespace

std::int64_t stepsOfState(std::span<const std::byte> bytes) { return headOf(bytes).step; }

std::vector<std::byte> World::stateBytes() const {
  return withMemory("stateBytes", [&] {
    impl_->flush();
    const Registry& r = impl_->registry;
    const std::vector<std::byte> engine = impl_->engine->snapshot()->bytes();
    StateHead head;
    head.doublePrecision = impl_->doublePrecision;
    head.step = r.step, head.time = r.time;
    head.bodies = r.bodies.size(), head.joints = r.joints.size();
    head.deformables = r.softs.size(), head.attachments = r.attachments.size();
    head.size = engine.size(), head.hash = hashOf(engine);
    std::vector<std::byte> out(sizeof head + engine.size());
    std::memcpy(out.data(), &head, sizeof head);
    std::ranges::copy(engine, out.begin() + sizeof head);
    return out;
  });
}

void World::setStateBytes(std::span<const std::byte> bytes) {
  withMemory("setStateBytes", [&] {
    if (impl_->inputs) throw Error("state", "a world without an input sink", "one with a sink");
    impl_->flush();
    const StateHead head = headOf(bytes);
    Registry& r = impl_->registry;
    if ((head.doublePrecision != 0) != impl_->doublePrecision)
      throw Error("state", "one of the precision of this backend",
                  head.doublePrecision ? "one in double" : "one in float");
    const auto expect = [](const char* what, std::int32_t own, std::int32_t theirs) {
      if (own != theirs)
        throw Error(std::string("state.") + what, std::to_string(own), std::to_string(theirs));
    };
    expect("bodies", r.bodies.size(), head.bodies), expect("joints", r.joints.size(), head.joints);
    expect("deformables", r.softs.size(), head.deformables);
    expect("attachments", r.attachments.size(), head.attachments);
    const std::span<const std::byte> state = bytes.subspan(sizeof head);
    impl_->engine->restore(SavedState({state.begin(), state.end()}));
    r.step = head.step, r.time = head.time;
    ++impl_->epoch;
    const std::vector<std::pair<int, int>> broken = impl_->engine->read().brokenJoints();
    for (const JointId id : r.joints.ids()) {
      const JointRecord& joint = r.joints[id];
      const std::pair<int, int> own{static_cast<int>(joint.engine.type), joint.engineSlot};
      if (std::ranges::binary_search(broken, own) != joint.broken) r.joints.edit(id).broken = !joint.broken;
    }
    r.hasUnlistedBreaks = false;
    // the next step reports what begins and ends from here on
    impl_->events = {};
    if (impl_->wantsEvents) {
      Events ignored;
      r.touches = impl_->collectContacts(ignored);
      r.sleepers = impl_->collectSleeps(ignored);
    }
  });
}

}  // namespace rubble
