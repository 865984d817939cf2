#pragma once
/// Keeps host tables and device tables consistent. Edits are made on the host and sent before they are
/// needed. Results of a step are fetched when they are read.
#include <algorithm>
#include <cstdint>
#include <vector>

#include "backend/arrays_by_id.h"
#include "backend/cuda/cuda_stepper.h"
#include "backend/cuda/device_joint_rows.h"
#include "backend/cuda/device_snapshot.h"
#include "backend/cuda/packet.h"
#include "backend/cuda/stream_order.h"
#include "backend/cuda/world_splice.h"
#include "collision/ray_arrays.h"
#include "tables/table_edit.h"
#include "tables/world_state.h"

namespace rubble::RUBBLE_CORE {

class Mirror {
 public:
  explicit Mirror(CudaStepper& stepper) : stepper_(stepper) {}

  HostTables& host() { return host_; }
  StreamOrder& order() { return order_; }
  const StreamOrder& order() const { return order_; }
  const HostTables& host() const { return host_; }

  // Notifications that an edit wrote host tables.
  void bodiesAdded(int before);  ///< new slots: `before` and above
  void bodyWritten(int slot) {
    mark(slot, kBody);
    authored_.reset();
  }
  void bodyParamsWritten(int slot) {
    mark(slot, kParams);
    authored_.reset();
  }
  void stateWritten(int slot) { mark(slot, kState); }
  void forceWritten(int slot) {
    mark(slot, kForce);
    forced_ = true;
  }
  void jointWritten(int type, int slot);  ///< authored data and state
  void specWritten(int type, int slot);   ///< authored data only
  /// All elements of authored arrays of a kind.
  void listWritten(Per per) {
    resend_[static_cast<int>(per)] = true;
    authored_.reset();
  }
  void shapeWritten(const ShapePlace& place) {
    sentShapes_ = {std::min(sentShapes_.vectors, place.vectors), std::min(sentShapes_.indices, place.indices),
                   std::min(sentShapes_.parts, place.parts)};
    authored_.reset();
  }
  void verticesWritten(int first, int count);
  void vertexForceWritten(int vertex) {
    forcedVertices_.push_back(vertex);
    forced_ = true;
  }
  /// Receives the elements that the next plan of joint trees writes.
  TreeChanges& treeChanges() { return trees_; }
  /// Receives the elements of the table of excluded pairs that an edit writes.
  std::vector<int>& exclusionsWritten() {
    authored_.reset();
    return exclusions_;
  }
  /// The constants of the step in these worlds.
  void constantsWritten(std::span<const int> worlds) {
    constants_.insert(constants_.end(), worlds.begin(), worlds.end());
  }
  void allWritten();  ///< after loading: the content of the device is obsolete
  void forgetContacts(std::span<const int> ids);
  /// The device has sorted its bodies.
  void bodiesSorted();

  /// Changes the velocity of a body, on the device unless the host has the present state.
  void addVelocity(int slot, const rubble::Vec3& change);
  /// As Engine::scatter. The host tables become outdated.
  void scatter(StateArray which, const ArrayView& rows, const ArrayView& values);
  /// As Engine::array, in device memory.
  ArrayView array(StateArray which);
  ArrayView array(VertexArray which);
  // Rows of joints, and sensors.
  void setJointRows(const JointRows& rows) { jointRows_.set(rows, stepper_.stream()); }
  ArrayView array(JointArray which) {
    return filled([&] { return jointRows_.view(present(), which, stepper_.stream()); });
  }
  ArrayView array(SensorArray which) {
    return filled(
        [&] { return jointRows_.view(present(), which, host_.bodyIds, oldPairs(), stepper_.stream()); });
  }
  ArrayView contactForces(std::span<const std::array<int, 2>> pairs) {
    return filled([&] { return jointRows_.contactForces(present(), pairs, stepper_.stream()); });
  }
  void scatter(JointArray which, const ArrayView& rows, const ArrayView& values);
  /// Calls cast(device) in the order of the streams of the rays. It gives hits in memory of the device.
  template <class Cast> RayHitArrays castRays(const EngineRays& rays, const Cast& cast) {
    flush();
    RayHitArrays hits;
    {
      const StreamOrder::Writing writing(order_);
      const ArrayView* const given[] = {&rays.origins, &rays.directions, &rays.worlds};
      for (const ArrayView* const view : given) order_.follow(view->stream);
      hits = cast(present());
      for (const ArrayView* const view : given) order_.lead(view->stream);
    }
    return {handOut(hits.distances), handOut(hits.bodies), handOut(hits.normals)};
  }
  /// Updates the arrays by id after a step.
  void followArrays();
  /// Number of pairs of the last step on the device.
  int oldPairs() const { return liveCount(Per::Pair); }
  /// Call before a force is added on the host: fetches forces that exist on the device only.
  void beforeForce() {
    if (forcesOnDevice_) fetchAll();
  }

  std::shared_ptr<const DeviceSnapshot> snapshot(double previousDt);
  void restore(const DeviceSnapshot& snapshot);

  // Worlds of a batch without vertices (mirror_worlds.cpp).
  /// Updates the persistent state of one world on the host.
  void fetchWorld(int world, const WorldPart& part);
  /// These worlds have new elements on the host, and these contacts.
  void worldsWritten(std::span<const WorldPart> parts, std::span<const WorldChange> changes,
                     const BodyContacts& contacts);
  /// SolverData::paused has changed.
  void pausedWritten() { resendPaused_ = true; }
  /// Keeps the state of all worlds on the device.
  void keepWorlds();
  /// Gives paused worlds the state that was kept.
  void putBackPaused();

  /// Sends all pending edits.
  void flush();
  /// The device has taken a step or substep.
  void stepped(const Counters& counters);
  /// The device has received contacts and joints from other devices.
  void gathered() { restOld_ = true; }
  /// As for host tables.
  void endForces();

  /// Updates position, orientation and velocities of one body on the host.
  void fetchState(int slot);
  /// Updates positions and velocities of vertices on the host.
  void fetchVertices();
  /// Updates all persistent state on the host.
  void fetchAll();

 private:
  /// Flags of a slot.
  enum : std::uint8_t {
    kBody = 1,             ///< pending upload: everything
    kState = 2,            ///< pending upload: position, orientation, velocities
    kForce = 4,            ///< pending upload: force and torque
    kKnown = 8,            ///< the host's state of this slot is up to date
    kPushed = 16,          ///< has a force until the next step
    kVelocityEdited = 32,  ///< pending velocity change on the device
    kParams = 64,          ///< pending upload: everything but the state
  };

  void mark(int slot, std::uint8_t bits);
  std::vector<int> slotsWith(std::uint8_t bits) const;
  int liveCount(Per per) const;
  void reserveDevice();
  void sendAll();
  void sendLists();
  void sendShapes();
  void sendEdits();
  void addTrees(Packet& packet);
  void addVertices(Packet& packet);
  void noteForces();
  /// The tables of the device with the sizes of the host.
  SolverData present() { return onDevice(host_.view(), stepper_.tables().view()); }
  /// A view of memory of the device, which readers may have.
  ArrayView handOut(ArrayView view);
  /// A view of memory that fill() writes and returns.
  template <class Fill> ArrayView filled(const Fill& fill) {
    flush();
    const auto write = [&] {
      const StreamOrder::Writing writing(order_);
      return fill();
    };
    return handOut(write());
  }
  /// Calls write(rows, values) with both in device memory, in the order of their streams.
  template <class Write> void withValues(const ArrayView& rows, const ArrayView& values, const Write& write);
  /// A scatter has changed states on the device.
  void scattered(bool forces);
  /// Replaces the contacts of worlds by those of `b`.
  void splice(const ContactTables& b, const int* firstInB);
  template <class T> void upload(const ArrayInfo<T>& array, int first, int count);
  template <class T> void download(const ArrayInfo<T>& array, int first, int count) {
    const std::size_t bytes = sizeof(T) * static_cast<std::size_t>(count);
    checkCuda(cudaMemcpyAsync(&(host_.view().*array.member)[0] + first,
                              &(stepper_.tables().view().*array.member)[0] + first, bytes,
                              cudaMemcpyDeviceToHost, stepper_.stream()),
              "cudaMemcpyAsync to the host");
  }
  template <class T> void download(const ArrayInfo<T>& array, int count) { download(array, 0, count); }
  auto gather() const {
    return [this](std::byte* to, const void* from, int bytes) {
      gatherById(stepper_.stream(), to, from, stepper_.tables().view().placeOf, host_.bodyIds,
                 bytes / static_cast<int>(sizeof(int)));
    };
  }
  void fetchStates();
  /// Updates the targets of drives on the host.
  void fetchTargets();

  CudaStepper& stepper_;
  HostTables host_;
  Upload upload_;
  std::vector<std::uint8_t> bits_;  ///< flags of each body
  std::vector<int> touched_;        ///< bodies with flags
  std::vector<int> joints_[JointTypes::kSize], specs_[JointTypes::kSize];
  std::vector<int> forgotten_;
  std::vector<int> velocityEdits_;  ///< bodies with pending velocity changes, and the changes [m/s]
  std::vector<Vec3d> velocityChanges_;
  std::shared_ptr<const AuthoredBytes> authored_;  ///< of the last snapshot, while it is up to date
  int addedFrom_ = -1;                             ///< first body that is not on the device yet, or -1
  bool resend_[kPerCount] = {};                    ///< kinds whose authored arrays are sent as a whole
  ShapePlace sentShapes_;                          ///< up to here the device has the tables of shapes
  TreeChanges trees_;
  std::vector<int> treeChildren_;  ///< elements of treeChild in trees_
  std::vector<int> exclusions_, movedVertices_, dynamicVertices_, forcedVertices_;
  std::vector<int> constants_;   ///< worlds whose constants have changed
  std::vector<int> worldsRead_;  ///< worlds whose state on the host is that of the device
  StateCopy present_, kept_;     ///< of the contacts before a splice, and of paused worlds
  bool keptForces_ = false, keptRolling_ = false;
  DeviceBuffer counts_;
  Pinned<ContactCounts> total_;
  bool allDirty_ = true;  ///< the device has no data yet
  bool edited_ = false;   ///< pending edits change arrays that readers may have
  bool resendPaused_ = false;
  bool targetsOnDevice_ = false;  ///< targets of drives on the device are newer
  bool statesOld_ = false, verticesOld_ = false, restOld_ = false;
  bool forcesOnDevice_ = false;  ///< some forces exist on the device only
  bool forced_ = false;          ///< the device may have forces
  int singleFetches_ = 0;
  Pinned<BodyMotionState> fetched_;
  ArraysById<DeviceBuffer> byId_;
  DeviceJointRows jointRows_;
  StreamOrder order_{stepper_.stream()};
};

/// The arrays of BodyState, and those derived from them.
template <class F> void forEachMotionArray(F&& f) {
  f(&SolverData::position), f(&SolverData::orientation), f(&SolverData::velocity),
      f(&SolverData::angularVelocity), f(&SolverData::previousVelocity), f(&SolverData::asleep),
      f(&SolverData::stillTime);
}

}  // namespace rubble::RUBBLE_CORE
