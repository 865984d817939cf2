#pragma once
/// What a step says of itself, and what can be measured of a world.
#include <cstdint>
#include <string>
#include <vector>

#include <rubble/ids.h>

namespace rubble {

struct StageTime {
  std::string name;
  double ms = 0;
};

/// A table that was too small in a step and grew: nothing was dropped.
struct Growth {
  std::string what;         ///< a kind that World::reserve() takes
  std::int64_t needed = 0;  ///< elements that the step had
};

struct StepReport {
  std::int64_t step = 0;      ///< index of the step just taken
  int bodies = 0;             ///< dynamic, kinematic and static
  int pairs = 0;              ///< found by the broad phase
  int manifolds = 0;          ///< touching pairs
  int contacts = 0;           ///< contact points
  int vertices = 0;           ///< of deformable objects, granular particles among them
  int vertexContacts = 0;     ///< contact points of vertices
  int deflectedVertices = 0;  ///< vertices whose way was changed where surfaces would have crossed
  int heldVertices = 0;       ///< and those that had to go less far for it
  int surfaceRounds = 0;  ///< rounds in which ways were changed, cut or given up until no surfaces crossed;
                          ///< bounded
  std::int64_t surfaceTests = 0;  ///< pairs of features that were looked at in all of them, at most
  int recycled = 0;               ///< manifolds kept without a new narrow-phase test
  int colors = 0;
  int colorRounds = 0;          ///< rounds of the colouring until it was proper
  int clashes = 0;              ///< neighbours left with one colour (0, or Jacobi pairs)
  int brokenJoints = 0;         ///< joints that broke in this step
  std::vector<JointId> broken;  ///< which, by index
  int sleepingBodies = 0;       ///< after the step
  int stoppedBodies = 0;  ///< fast bodies that stopped where they met another; the next step deals with the
                          ///< impact
  int quarantined = 0;    ///< bodies frozen in this step because their state was not finite
  int failedSolves = 0;   ///< local problems left unsolved for an iteration because they were not positive
                          ///< definite or not finite
  int boundedSteps = 0;   ///< local problems whose solution had more kinetic energy than their forces did
                          ///< work, all round-off: a shorter step was made
  int spinLimited = 0;    ///< bodies whose spin was above 2 rad a step and was limited
  int unsettledImpacts = 0;  ///< contacts with restitution whose bodies still closed after the last round of
                             ///< an impact: the next step goes on with them
  /// Largest motion of a body in the last sweep, over its bounding diameter: more iterations would go on from
  /// there [1].
  double unfinishedMotion = 0;
  bool sorted = false;  ///< before the step the bodies were put in another order in memory: views of arrays
                        ///< made earlier are no longer valid
  int restarts = 0;     ///< times the step was begun again with more room
  std::vector<Growth> grown;  ///< what there was too little room for
  std::vector<StageTime> stages;
  double totalMs = 0;  ///< wall clock of the step

  double stageMs(const std::string& name) const;
};

/// What the solver keeps of a body or a vertex of a deformable object after the last step.
struct SolverState {
  int color = -1;         ///< those of one colour are solved at the same time; -1: none
  double stiffness = 0;   ///< largest stiffness k of the rows that act on it: contacts, attachments, linear
                          ///< rows of joints [N/m]
  double multiplier = 0;  ///< largest multiplier |lambda| of these rows [N]
};

struct Distribution {
  double mean = 0, p99 = 0, max = 0;
};

/// Quality of the present state, from the contacts and joints of the last step.
struct Quality {
  Distribution penetration;  ///< depth of touching points [m]
  double jointGapMean = 0;   ///< distance of the anchors of ball and fixed joints [m]
  double jointGapMax = 0;
  double kineticEnergy = 0;    ///< [J]
  double potentialEnergy = 0;  ///< in the scene's gravity, from the origin [J]
  double maxSpeed = 0;         ///< [m/s]
};

}  // namespace rubble
