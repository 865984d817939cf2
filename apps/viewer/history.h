#pragma once
/// History of the inputs to a running scene, as a tree of branches. The state at any step follows from the
/// scene and these inputs; snapshots only save time.
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <rubble/world.h>

namespace rubble::viewer {

/// An input applied to the worlds before step `step`.
struct Input {
  std::int64_t step = 0;
  std::string what;
  std::function<void(World&)> apply;
};

/// State of a world and of its actuators.
struct Checkpoint {
  Snapshot world;
  std::vector<double> activations;
};

struct Branch {
  std::string name;
  int parent = -1;
  std::int64_t begins = 0;    ///< step at which it leaves its parent
  std::int64_t last = 0;      ///< last step reached
  std::vector<Input> inputs;  ///< from the start of the scene on, in order
  std::map<std::int64_t, std::vector<Checkpoint>>
      checkpoints;  ///< one per world, before the inputs of that step
};

class History {
 public:
  /// `bytes`: of a snapshot of all worlds; how many are kept follows from it.
  void begin(std::vector<Checkpoint> start, std::size_t bytes);

  const std::vector<Branch>& branches() const { return branches_; }
  const Branch& branch() const { return branches_[static_cast<std::size_t>(current_)]; }
  int current() const { return current_; }
  void choose(int branch);

  /// The next input due at this step, or null. A returned input counts as applied.
  const Input* due(std::int64_t step);
  /// Adds an input at this step. If the branch already has later steps, a new branch begins. With `replaces`
  /// it replaces the last input of the same kind in the same step.
  void add(Input input, bool replaces);
  /// Should a snapshot be taken at this step?
  bool wantsCheckpoint(std::int64_t step) const;
  void reached(std::int64_t step) { own().last = std::max(own().last, step); }
  void keep(std::int64_t step, std::vector<Checkpoint> worlds);
  /// The latest checkpoint at or before a step.
  const std::pair<const std::int64_t, std::vector<Checkpoint>>& before(std::int64_t step) const;
  /// The worlds are restored to the checkpoint of this step; earlier inputs count as applied.
  void rewound(std::int64_t step);

 private:
  Branch& own() { return branches_[static_cast<std::size_t>(current_)]; }
  void fork(std::int64_t step);

  std::vector<Branch> branches_;
  int current_ = 0;
  std::size_t done_ = 0;  ///< inputs of the branch that have been applied
  std::size_t maxCheckpoints_ = 1;
  std::int64_t spacing_ = 1;  ///< of checkpoints [steps]
};

}  // namespace rubble::viewer
