#pragma once
/// The tables of the host beside those of the device. Edits are made on the host and sent before they are needed; what a step has changed
/// is fetched when somebody asks.
#include <cstdint>
#include <vector>

#include "backend/cpu/table_edit.h"
#include "backend/cuda/cuda_stepper.h"

namespace rubble::RUBBLE_CORE {

class Mirror {
 public:
  explicit Mirror(CudaStepper& stepper) : stepper_(stepper) {}

  HostTables& host() { return host_; }
  const HostTables& host() const { return host_; }

  // What an edit of the host's tables has written.
  void bodiesAdded(int before);  ///< slots from `before` on
  void bodyWritten(int slot) { mark(slot, kBody); }
  void stateWritten(int slot) { mark(slot, kState); }
  void forceWritten(int slot) { mark(slot, kForce); }
  void jointWritten(int type, int slot);
  void listsWritten() { listsDirty_ = true; }  ///< planes or exclusions
  void allWritten();                           ///< by loading: nothing of the device matters any more
  void forgetContacts(int slot);

  /// Sends all edits.
  void flush();
  /// The device has taken a step.
  void stepped(const Counters& counters);

  /// Position, orientation and velocities of one body are as on the device.
  void fetchState(int slot);
  /// All that lasts from step to step is as on the device.
  void fetchAll();

 private:
  /// Bits of a slot.
  enum : std::uint8_t {
    kBody = 1,     ///< to be sent: everything
    kState = 2,    ///< to be sent: position, orientation, velocities
    kForce = 4,    ///< to be sent: force and torque
    kKnown = 8,    ///< the state of this slot is that of the device, or newer
    kPushed = 16,  ///< has a force until the next step
  };
  class Packet;

  void mark(int slot, std::uint8_t bits);
  std::vector<int> slotsWith(std::uint8_t bits) const;
  int liveCount(Per per) const;
  void reserveDevice();
  void sendAll();
  void sendLists();
  void sendBodies(Packet& packet);
  void sendJoints(Packet& packet);
  template <class T>
  void download(const ArrayInfo<T>& array, int count);
  void fetchStates();

  CudaStepper& stepper_;
  HostTables host_;
  DeviceBuffer staging_;
  std::vector<std::uint8_t> bits_;  ///< of each body
  std::vector<int> touched_;        ///< bodies with bits
  std::vector<int> joints_[JointTypes::kSize];
  std::vector<int> forgotten_;
  int addedFrom_ = -1;  ///< first body that the device does not know, or -1
  bool listsDirty_ = false;
  bool allDirty_ = true;  ///< the device has nothing yet
  bool statesOld_ = false, restOld_ = false;
  int singleFetches_ = 0;
};

}  // namespace rubble::RUBBLE_CORE
