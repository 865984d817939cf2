#pragma once
/// Everything that was ever done to a running scene, as a tree of branches: its state at any step follows
/// from the scene and from these inputs, so that snapshots only save time.
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <rubble/world.h>

namespace rubble::viewer {

/// Something that was done to the worlds before the step of that index is taken.
struct Input {
  std::int64_t step = 0;
  std::string what;
  std::function<void(World&)> apply;
};

struct Branch {
  std::string name;
  int parent = -1;
  std::int64_t begins = 0;    ///< where it left its parent
  std::int64_t last = 0;      ///< step that was reached
  std::vector<Input> inputs;  ///< from the start of the scene on, in order
  std::map<std::int64_t, std::vector<Snapshot>>
      moments;  ///< one snapshot a world, before the inputs of that step
};

class History {
 public:
  /// `bytes`: of a snapshot of all worlds; how many are kept follows from it.
  void begin(std::vector<Snapshot> start, std::size_t bytes);

  const std::vector<Branch>& branches() const { return branches_; }
  const Branch& branch() const { return branches_[static_cast<std::size_t>(current_)]; }
  int current() const { return current_; }
  void choose(int branch);

  /// The next input that is due at this step, or null. What is taken counts as done.
  const Input* due(std::int64_t step);
  /// Something new is done at this step. Where the branch goes on already, a new one begins. Inputs of one
  /// step that replace one another
  /// (`replaces`: the last one was of the same kind) are kept once.
  void add(Input input, bool replaces);
  /// A step was reached: is a snapshot wanted here?
  bool wantsMoment(std::int64_t step) const;
  void reached(std::int64_t step) { own().last = std::max(own().last, step); }
  void keep(std::int64_t step, std::vector<Snapshot> worlds);
  /// The latest moment at or before a step.
  const std::pair<const std::int64_t, std::vector<Snapshot>>& before(std::int64_t step) const;
  /// The worlds are at this moment again: what was done before it is done.
  void rewound(std::int64_t step);

 private:
  Branch& own() { return branches_[static_cast<std::size_t>(current_)]; }
  void fork(std::int64_t step);

  std::vector<Branch> branches_;
  int current_ = 0;
  std::size_t done_ = 0;  ///< inputs of the branch that have been applied
  std::size_t mostMoments_ = 1;
  std::int64_t spacing_ = 1;  ///< of moments [steps]
};

}  // namespace rubble::viewer
