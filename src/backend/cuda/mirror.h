#pragma once
/// The tables of the host beside those of the device. Edits are made on the host and sent before they are
/// needed; what a step has changed is fetched when somebody asks.
#include <cstdint>
#include <vector>

#include "backend/arrays_by_id.h"
#include "backend/cuda/cuda_stepper.h"
#include "backend/cuda/device_snapshot.h"
#include "backend/cuda/packet.h"
#include "tables/table_edit.h"

namespace rubble::RUBBLE_CORE {

class Mirror {
 public:
  explicit Mirror(CudaStepper& stepper) : stepper_(stepper) {}

  HostTables& host() { return host_; }
  const HostTables& host() const { return host_; }

  // What an edit of the host's tables has written.
  void bodiesAdded(int before);  ///< slots from `before` on
  void bodyWritten(int slot) {
    mark(slot, kBody);
    authored_.reset();
  }
  void stateWritten(int slot) { mark(slot, kState); }
  void forceWritten(int slot) {
    mark(slot, kForce);
    forced_ = true;
  }
  void jointWritten(int type, int slot);  ///< all of a joint
  void specWritten(int type, int slot);   ///< what is authored of it
  void listsWritten() {                   ///< planes or exclusions
    listsDirty_ = true;
    authored_.reset();
  }
  void derivedWritten() { listsDirty_ = true; }
  void allWritten();  ///< by loading: nothing of the device matters any more
  void forgetContacts(int slot);
  /// By the device.
  void bodiesSorted();

  /// Changes the velocity of a body, on the device unless the host knows it.
  void addVelocity(int slot, const rubble::Vec3& change);
  /// As Engine::scatter; the host's tables do not follow.
  void scatter(StateArray which, const ArrayView& rows, const ArrayView& values);
  /// As Engine::array, on the device.
  ArrayView array(StateArray which);
  /// Arrays by id follow a step.
  void followArrays();
  /// Of the step before, on the device.
  int oldPairs() const { return liveCount(Per::Pair); }
  /// Before a force of the host is added: those that lie on the device only are fetched.
  void beforeForce() {
    if (forcesOnDevice_) fetchAll();
  }

  std::shared_ptr<const DeviceSnapshot> snapshot(double previousDt);
  void restore(const DeviceSnapshot& snapshot);

  /// Sends all edits.
  void flush();
  /// The device has taken a step, or a substep.
  void stepped(const Counters& counters);
  /// As for tables of the host.
  void endForces();

  /// Position, orientation and velocities of one body are as on the device.
  void fetchState(int slot);
  /// All that lasts from step to step is as on the device.
  void fetchAll();

 private:
  /// Bits of a slot.
  enum : std::uint8_t {
    kBody = 1,      ///< to be sent: everything
    kState = 2,     ///< to be sent: position, orientation, velocities
    kForce = 4,     ///< to be sent: force and torque
    kKnown = 8,     ///< the state of this slot is that of the device, or newer
    kPushed = 16,   ///< has a force until the next step
    kSwerved = 32,  ///< to be changed on the device: velocity
  };

  void mark(int slot, std::uint8_t bits);
  std::vector<int> slotsWith(std::uint8_t bits) const;
  int liveCount(Per per) const;
  void reserveDevice();
  void sendAll();
  void sendLists();
  void sendEdits();
  void noteForces();
  template <class T> void download(const ArrayInfo<T>& array, int count);
  auto gather() const {
    return [this](std::byte* to, const void* from, int bytes) {
      gatherById(stepper_.stream(), to, from, stepper_.tables().view().placeOf, host_.view().bodies,
                 bytes / static_cast<int>(sizeof(int)));
    };
  }
  void fetchStates();

  CudaStepper& stepper_;
  HostTables host_;
  Upload upload_;
  std::vector<std::uint8_t> bits_;  ///< of each body
  std::vector<int> touched_;        ///< bodies with bits
  std::vector<int> joints_[JointTypes::kSize], specs_[JointTypes::kSize];
  std::vector<int> forgotten_;
  std::vector<int> swerved_;  ///< bodies whose velocity changes on the device, and by how much [m/s]
  std::vector<Vec3d> swerves_;
  std::shared_ptr<const AuthoredBytes> authored_;  ///< of the last snapshot, while it is up to date
  int addedFrom_ = -1;                             ///< first body that the device does not know, or -1
  bool listsDirty_ = false;
  bool allDirty_ = true;  ///< the device has nothing yet
  bool statesOld_ = false, restOld_ = false;
  bool forcesOnDevice_ = false;  ///< some that the host's tables do not have
  bool forced_ = false;          ///< there may be some on the device
  int singleFetches_ = 0;
  ArraysById<DeviceBuffer> byId_;
  StreamEvent
      handed_;  ///< a place in a stream of a caller of scatter(), or in ours before the caller goes on
};

/// The arrays that BodyState is made of, and what follows from it.
template <class F> void forEachMotionArray(F&& f) {
  f(&SolverData::position), f(&SolverData::orientation), f(&SolverData::velocity),
      f(&SolverData::angularVelocity), f(&SolverData::previousVelocity), f(&SolverData::asleep),
      f(&SolverData::stillTime);
}

}  // namespace rubble::RUBBLE_CORE
