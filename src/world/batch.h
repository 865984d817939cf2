#pragma once
/// Many worlds in one engine. Each world sees an engine of its own, with its own numbers of bodies, joints
/// and vertices (WorldSlice).
#include <map>
#include <optional>
#include <set>

#include "backend/engine.h"
#include "world/shape_space.h"

namespace rubble {

/// Element i of a list.
template <class List> auto& slotAt(List& list, int i) { return list[static_cast<std::size_t>(i)]; }

/// What a world refers to, in its own numbers. A snapshot has a copy.
struct WorldReferences {
  std::vector<AddShape> shapes;  ///< ascending in the places of their indices
  std::vector<Material> surfaces;
  std::vector<EngineMaterialRule> rules;  ///< of these materials
  std::vector<int> planes;                ///< bodies
  std::set<std::pair<int, int>> excluded;
  std::vector<EngineSoftObject> objects;      ///< `previous`: in the tables
  std::vector<EngineAttachment> attachments;  ///< the same
};

/// State of a world of a batch. Can be restored to every world of the same family.
class WorldSnapshot final : public EngineSnapshot {
 public:
  std::vector<std::byte> bytes() const override;

  std::shared_ptr<const int> family;
  std::vector<std::byte> state;
  double previousDt = 0;
  std::size_t bodies = 0;
  std::vector<std::size_t> joints;  ///< slots by type
  WorldReferences references;
};

class Batch {
 public:
  /// `family`: shared by the batches whose worlds exchange snapshots. Throws Error if the engine can hold one
  /// world only.
  Batch(std::unique_ptr<Engine> engine, const Params& params, std::shared_ptr<const int> family);

  int count() const { return static_cast<int>(own_.members.size()); }
  int addWorld();
  /// Takes back the last addWorld(), with everything that the world has.
  void dropWorld() noexcept;
  /// Applies edits of a world in their order, all of them or none.
  void apply(int world, std::span<const Edit> edits);
  /// Places the elements that edits have added. Without memory for it nothing is lost: the next call goes on.
  void flush();
  Engine& engine() { return *engine_; }
  BatchEngine& worlds() { return *engine_->batch(); }
  /// Row in the arrays of the engine of each body of a world.
  const std::vector<int>& rowsOf(int world) const {
    return own_.members[static_cast<std::size_t>(world)].bodies;
  }
  /// Number of rows, with those of bodies of no world.
  int rows() const { return own_.bodies; }
  void setParams(const Params& params);
  void configure(int world, const EngineSettings& settings);

  std::shared_ptr<const WorldSnapshot> snapshot(int world);
  /// Throws Error unless a world of this batch can be restored from it.
  const WorldSnapshot& own(const EngineSnapshot& snapshot) const;
  void setJointRows(int world, const JointRows& rows);
  /// Gives the rows of all worlds to the engine, if they have changed. Call before joint arrays.
  void sendJointRows();
  /// First row of a world in the arrays of axes and of joints, valid after sendJointRows(). `world` may be
  /// count().
  int firstAxis(int world) const { return firstAxis_[static_cast<std::size_t>(world)]; }
  int firstJoint(int world) const { return firstJoint_[static_cast<std::size_t>(world)]; }
  /// First row of a world in the arrays of vertices, and their number, valid after flush().
  int firstVertex(int world) const { return own_.members[static_cast<std::size_t>(world)].first.vertex; }
  int vertices(int world) const { return own_.members[static_cast<std::size_t>(world)].count.vertex; }

  /// States that worlds are about to have. Without commit() they keep those that they had.
  class Restoring;
  /// `snapshots`: one for each of the worlds, which are distinct. They must outlive the result, which is used
  /// before any other call.
  std::unique_ptr<Restoring> prepareToRestore(std::span<const int> worlds,
                                              std::span<const WorldSnapshot* const> snapshots);

 private:
  struct Member {
    std::vector<int> bodies;               ///< ids in the tables
    std::vector<std::vector<int>> joints;  ///< slots in the tables, by type
    WorldReferences references;
    std::vector<WorldShape> shapes;  ///< of its references, in the tables
    std::vector<int> surfaces;       ///< the same
    SoftRange first, count;          ///< of its deformable objects in the tables
    int firstAttachment = 0, attachments = 0;
    JointRows rows;
    std::optional<EngineSettings> settings;  ///< not yet given to the engine
  };
  struct ShapeInTables {
    ShapePlace place;
    int uses = 0;  ///< by worlds
  };
  /// What has changed since flush().
  struct Changed {
    bool layout = false, softs = false, planes = false, rules = false, settings = false;
  };
  /// Everything that the batch knows of its worlds and of what they share.
  struct Records {
    std::vector<Member> members;
    int bodies = 0;
    std::vector<int> jointSlots;                ///< by type
    std::vector<int> spareBodies;               ///< of no world; there is room for all
    std::vector<std::vector<int>> spareJoints;  ///< likewise, by type
    std::vector<Material> surfaces;
    std::vector<EngineMaterialRule> rules;  ///< those in the tables, of all worlds
    std::map<std::shared_ptr<const CookedShape>, ShapeInTables> shapes;
    ShapeSpace space;  ///< there is room to give back all shapes
    Changed changed;

    /// A copy has less room.
    void makeRoom() {
      spareBodies.reserve(static_cast<std::size_t>(bodies));
      for (std::size_t type = 0; type < spareJoints.size(); ++type)
        spareJoints[type].reserve(static_cast<std::size_t>(jointSlots[type]));
      space.prepare(static_cast<int>(shapes.size()));
    }
  };
  class Translation;
  int takeBody();
  int takeJoint(int type, int least);
  int surfaceOf(const Material& material);
  void flushRules();
  void flushPlanes();
  /// Finds or makes the place of a shape in the tables. The edits receive a new one.
  ShapePlace placeShape(const AddShape& shape, std::vector<Edit>& edits);
  /// Takes back one call of placeShape().
  void dropShape(const std::shared_ptr<const CookedShape>& shape) noexcept;
  void flushSofts();
  bool sameElements(int world, const WorldSnapshot& snapshot) const;
  void takeElements(int world, const WorldSnapshot& snapshot);

  std::unique_ptr<Engine> engine_;
  Params params_;
  std::shared_ptr<const int> family_;
  Records own_;
  std::vector<int> firstAxis_, firstJoint_;  ///< [worlds + 1]
  bool rowsChanged_ = true;
  bool wakesAll_ = false;  ///< parameters have changed
};

class Batch::Restoring {
 public:
  ~Restoring();
  Restoring(const Restoring&) = delete;
  Restoring& operator=(const Restoring&) = delete;
  /// Needs no memory, unless the engine is on a device.
  void commit();

 private:
  friend Batch;
  explicit Restoring(Batch& batch) : batch_(batch) {}

  Batch& batch_;
  std::vector<std::pair<int, const WorldSnapshot*>> changes_;  ///< ascending in the worlds
  std::optional<Records> before_;                              ///< where worlds get other elements
  std::function<void()> putBack_, put_;
};

/// The engine of one world of a batch.
class WorldSlice final : public Engine {
 public:
  WorldSlice(std::shared_ptr<Batch> batch, int world) : batch_(std::move(batch)), world_(world) {}

  void configure(const EngineSettings& settings) override { batch_->configure(world_, settings); }
  void apply(std::span<const Edit> edits) override { batch_->apply(world_, edits); }
  /// A step of this world alone.
  void step(StepReport& report) override;
  void sortBodies() override;
  BodyState bodyState(int id) override { return batch_->engine().bodyState(row(id)); }
  const TableReader& read(Fetch, int) override {
    batch_->flush();
    return batch_->worlds().readWorld(world_);
  }
  std::span<EngineQuery> queryRoom(std::size_t n) override { return batch_->engine().queryRoom(n); }
  std::span<const EngineHit> hits(const EngineQueries& asked) override {
    return batch_->engine().hits(ofWorld(asked));
  }
  EngineAllHits allHits(const EngineQueries& asked) override {
    return batch_->engine().allHits(ofWorld(asked));
  }
  EngineOverlaps overlaps(const EngineQueries& asked) override {
    return batch_->engine().overlaps(ofWorld(asked));
  }
  RayHitArrays castRays(const EngineRays& rays) override {
    batch_->flush();
    EngineRays own = rays;
    own.firstWorld = world_;
    return batch_->engine().castRays(own);
  }
  ArrayView array(StateArray which) override;
  void scatter(StateArray which, const ArrayView& rows, const ArrayView& values) override;
  void setJointRows(const JointRows& rows) override { batch_->setJointRows(world_, rows); }
  ArrayView array(JointArray which) override;
  ArrayView array(SensorArray which) override;
  ArrayView array(VertexArray which) override;
  void scatter(JointArray which, const ArrayView& rows, const ArrayView& values) override;
  ArrayView contactForces(std::span<const std::array<int, 2>> pairs) override;
  DeviceArrays* deviceArrays() override { return batch_->engine().deviceArrays(); }
  bool reserve(const std::string& kind, int count) override { return batch_->engine().reserve(kind, count); }
  std::size_t memoryBytes() const override { return batch_->engine().memoryBytes(); }
  /// Of everything that the world has.
  std::vector<TableHash> tableHashes() override { return {{"world", hashOf(snapshot()->bytes())}}; }
  std::shared_ptr<const EngineSnapshot> snapshot() override { return batch_->snapshot(world_); }
  void restore(const EngineSnapshot& snapshot) override;

 private:
  ArrayView bodyRows(ArrayView all) const;
  void scatter(const std::vector<int>& ids, auto which, const ArrayView& rows, const ArrayView& values);
  int row(int id) const { return batch_->rowsOf(world_)[static_cast<std::size_t>(id)]; }
  const EngineQueries& ofWorld(const EngineQueries& asked);

  std::shared_ptr<Batch> batch_;
  int world_;
};

}  // namespace rubble
