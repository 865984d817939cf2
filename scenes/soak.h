#pragma once
/// A long run of random edits of a heap, with invariants checked after each step. The same seed gives the
/// same run.
#include <cstdint>
#include <string>
#include <vector>

#include <rubble/rubble.h>

namespace rubble::scenes {

struct SoakOptions {
  WorldOptions world;
  std::uint64_t seed = 1;
  int bodies = 500;    ///< mean size of the heap, which varies between half and one and a half times this
  bool joints = true;  ///< pairs of cubes on ball and fixed joints among them
};

/// Counts since the start.
struct SoakCounts {
  std::int64_t steps = 0;                                                   ///< taken, replayed ones included
  std::int64_t added = 0, removed = 0, pushed = 0, placed = 0, forced = 0;  ///< bodies
  std::int64_t joined = 0, parted = 0;                                      ///< joints
  std::int64_t sorts = 0;                                                   ///< of the bodies in memory
  std::int64_t snapshots = 0, restores = 0, replays = 0, reads = 0;
  std::int64_t growths = 0;  ///< tables that became larger
  int bodies = 0, mostBodies = 0;
  std::size_t memory = 0;  ///< of the engine's tables [bytes]
};

class Soak {
 public:
  explicit Soak(const SoakOptions& options);

  /// Random edits, one step and the checks. At intervals some steps are run twice from a snapshot and must
  /// give the same bits.
  void step();

  const SoakCounts& counts() const { return counts_; }
  /// What did not hold, "step 12: ..."; the first few of them.
  const std::vector<std::string>& faults() const { return faults_; }
  const World& world() const { return world_; }

 private:
  /// SplitMix64. A copy continues the same sequence.
  struct Random {
    std::uint64_t state;
    std::uint64_t bits();
    int below(int n) { return static_cast<int>(bits() % static_cast<std::uint64_t>(n)); }
    double uniform(double lo, double hi) {
      return lo + (hi - lo) * static_cast<double>(bits() >> 11) * 0x1p-53;
    }
    bool chance(double p) { return uniform(0, 1) < p; }
    Vec3 vector(double size) { return {uniform(-size, size), uniform(-size, size), uniform(-size, size)}; }
    Quat rotation();
  };

  void editAndStep();
  void edit();
  void addSome(int count);
  void removeSome(int count);
  void disturbSome();
  void changeJoints();
  void check(const StepReport& report);
  void checkStates();
  void replay();
  std::vector<BodyId> someBodies(int most);
  BodyDef randomBody();
  double halfWidth() const;
  void expect(bool holds, const std::string& what);

  SoakOptions options_;
  Random random_;
  World world_;
  std::vector<BodyId> alive_;    ///< bodies but the ground
  std::vector<BodyId> jointed_;  ///< those that were made with a joint
  SoakCounts counts_;
  std::vector<std::string> faults_;
  Snapshot kept_;
  std::uint64_t keptHash_ = 0;
  std::vector<BodyId> keptAlive_, keptJointed_;
  std::size_t mostSlots_ = 0;
  bool joinedNow_ = false;  ///< a joint came in this step: its type may need a row more
};

}  // namespace rubble::scenes
