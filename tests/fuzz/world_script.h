#pragma once
/// A world that is made and edited by the commands that bytes encode, with a model of what must be alive.
#include <string>
#include <vector>

#include <rubble/rubble.h>

#include "tests/fuzz/byte_source.h"

namespace rubble::fuzz {

/// How a script is run.
struct ScriptOptions {
  std::string backend = "cpu";
  int threads = 1;
  int mostCommands = 12, mostSteps = 4;
};

/// Runs a script. The same bytes give the same commands, whatever the number of threads.
class WorldScript {
 public:
  WorldScript(ByteSource bytes, const ScriptOptions& options);

  /// Runs all commands. Ends the process where a claim about the world does not hold.
  void run();
  /// World::hash() behind each command, and a fingerprint of all that is seen of the world at the end.
  const std::vector<std::uint64_t>& trace() const { return trace_; }
  /// The Errors that commands gave, by their number.
  const std::vector<std::string>& errors() const { return errors_; }

 private:
  /// What is alive, in the order of the lists that World returns.
  struct Alive {
    std::vector<BodyId> bodies;
    std::vector<JointId> joints;
    std::vector<DeformableId> deformables;
    std::vector<AttachmentId> attachments;
  };
  struct Memory {
    Snapshot snapshot;
    Alive alive;
    std::uint64_t hash;
  };

  void command();
  // Choices among what is alive; without any of it an id that is not.
  template <class Id> Id pick(const std::vector<Id>& ids) {
    const int choice = in_.byte();
    return ids.empty() || choice == 255 ? Id{choice, 7} : ids[static_cast<std::size_t>(choice) % ids.size()];
  }
  BodyId pickBodyOrWorld() { return in_.below(4) == 0 ? BodyId{} : pick(alive_.bodies); }

  // world_edits.cpp
  void addBodies();
  void addJoint();
  void addDeformable();
  void addAttachment();
  void remove();
  void setBody();
  void push();
  void changeJoint();
  void changeVertices();
  void changeSettings();
  void arrange();
  void query();
  // world_script.cpp
  void step();
  void remember();
  void forget();  ///< restores what remember() kept

  /// Removes from the model what the removal of bodies or objects takes along.
  void noteRemoved();
  void expectModel();
  void expectHonest(const StepReport& report);
  void expectFinite();

  ByteSource in_;
  ScriptOptions options_;
  WorldOptions worldOptions_;
  World world_;
  Alive alive_;
  std::vector<Memory> memories_;
  std::vector<std::uint64_t> trace_;
  std::vector<std::string> errors_;
  int steps_ = 0;
};

}  // namespace rubble::fuzz
