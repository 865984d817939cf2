#pragma once
/// A world that is made and edited by the commands that bytes encode, with a model of what must be alive.
#include <string>
#include <vector>

#include <rubble/rubble.h>

#include "tests/fuzz/byte_source.h"

namespace rubble::fuzz {

/// What else is in the world of a script, 100 km away: nothing; balls that stand still; or as many bodies
/// that move, touch and hang on a joint, and cloth.
enum class Company { None, Still, Moving };

/// How a script is run.
struct ScriptOptions {
  std::string backend = "cpu";
  int threads = 1;
  int mostCommands = 12, mostSteps = 4;
  Company company = Company::None;
};

/// Runs a script. The same bytes give the same commands, whatever the number of threads.
class WorldScript {
 public:
  WorldScript(ByteSource bytes, const ScriptOptions& options);

  /// Runs all commands. Ends the process where a claim about the world does not hold.
  void run();
  /// World::hash() behind each command, and a fingerprint of all that is seen of the world at the end.
  const std::vector<std::uint64_t>& trace() const { return trace_; }
  /// The fingerprint. Company is not in it.
  std::uint64_t end() const { return trace_.back(); }
  /// Must company not change it? All that the script has made has stayed far from it, and has the same ids
  /// and numbers of vertices as without: they break ties.
  bool isLocal() const { return farthest_ < kFar && !hadVertices_ && !meetsCompany_; }
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
  static constexpr double kFar = 1e4;  ///< [m]
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
  /// The ids that are not those of company.
  template <class Id> static std::vector<Id> without(std::vector<Id> ids, const std::vector<Id>& company);
  /// What is seen of the objects of the script.
  std::uint64_t fingerprint() const;
  void expectModel();
  void expectHonest(const StepReport& report);
  void expectFinite();

  ByteSource in_;
  ScriptOptions options_;
  WorldOptions worldOptions_;
  World world_;
  Alive company_, alive_;
  bool hadVertices_ = false, meetsCompany_ = false;
  double farthest_ = 0;  ///< that a part of the script's objects was from the origin [m]
  std::vector<Memory> memories_;
  std::vector<std::uint64_t> trace_;
  std::vector<std::string> errors_;
  int steps_ = 0;
};

}  // namespace rubble::fuzz
