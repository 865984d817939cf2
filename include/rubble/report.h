#pragma once
/// Report of a step, and measures of a world.
#include <cstdint>
#include <string>
#include <vector>

#include <rubble/ids.h>
#include <rubble/ranks.h>

namespace rubble {

struct StageTime {
  std::string name;
  double ms = 0;
};

/// A table that was too small for a step and grew. The step was completed, nothing was dropped.
struct Growth {
  std::string what;         ///< kind of element, as for World::reserve()
  std::int64_t needed = 0;  ///< elements in the step
};

/// With substeps, events and tests are added up, and of bodies, vertices and rounds the most of a substep
/// counts. All else is of the last one.
struct StepReport {
  std::int64_t step = 0;      ///< index of the step just taken
  int bodies = 0;             ///< dynamic, kinematic and static
  int pairs = 0;              ///< from the broad phase
  int manifolds = 0;          ///< touching pairs
  int contacts = 0;           ///< contact points
  int vertices = 0;           ///< vertices of deformable objects, granular particles included
  int vertexContacts = 0;     ///< contact points of vertices
  int deflectedVertices = 0;  ///< vertices whose displacement was changed so that no surfaces cross
  int heldVertices = 0;       ///< vertices whose displacement was shortened for that
  /// Rounds of changing, shortening or cancelling displacements until no surfaces cross. Bounded.
  int surfaceRounds = 0;
  std::int64_t surfaceTests = 0;  ///< feature pairs tested over all rounds, upper bound
  int recycled = 0;               ///< manifolds kept without a new narrow-phase test
  int colors = 0;
  int colorRounds = 0;          ///< rounds until the coloring was proper
  int clashes = 0;              ///< neighbors that share a color (0, or pairs solved as in Jacobi)
  int brokenJoints = 0;         ///< joints that broke in this step
  std::vector<JointId> broken;  ///< their ids, by index
  int sleepingBodies = 0;       ///< bodies that sleep after the step
  /// Fast bodies stopped by ccd at their time of impact. The next step resolves the impact.
  int stoppedBodies = 0;
  int quarantined = 0;  ///< bodies frozen in this step because their state is not finite
  /// Local problems skipped in an iteration because their Hessian is not positive definite, or not finite.
  int failedSolves = 0;
  /// Local problems whose step was shortened, because its kinetic energy exceeded the work of its forces
  /// (round-off).
  int boundedSteps = 0;
  int spinLimited = 0;  ///< bodies whose rotation was limited to 2 rad per step
  /// Contacts with restitution that still approach after the last round of an impact. The next step continues
  /// with them.
  int unsettledImpacts = 0;
  /// Largest displacement of a body in the last iteration, over its bounding diameter [1]. A measure of
  /// convergence.
  double unfinishedMotion = 0;
  /// The bodies were sorted in memory before the step. Earlier array views are invalid.
  bool sorted = false;
  std::string difference;     ///< lockstep only: the first difference found so far, or ""
  int restarts = 0;           ///< number of times the step was restarted with larger tables
  std::vector<Growth> grown;  ///< the tables that grew
  std::vector<StageTime> stages;
  std::vector<RankReport> ranks;  ///< distributed only: by rank
  double totalMs = 0;             ///< wall-clock time of the step, or of one in a call of Worlds::step

  double stageMs(const std::string& name) const;
};

/// Solver state of a body, or of a vertex of a deformable object, after the last step.
struct SolverState {
  int color = -1;  ///< bodies of one color are solved in parallel; -1: none
  /// Largest stiffness k of the rows on it: contacts, attachments, linear rows of joints [N/m].
  double stiffness = 0;
  double multiplier = 0;  ///< largest multiplier |lambda| of these rows [N]
};

/// Hash of one table of the persistent state of a world.
struct TableHash {
  std::string table;  ///< "position", "joint ball", "authored params" ...
  std::uint64_t hash = 0;
};

struct Distribution {
  double mean = 0, p99 = 0, max = 0;
};

/// Quality measures of the present state, from the contacts and joints of the last step.
struct Quality {
  Distribution penetration;  ///< depth of touching contact points [m]
  double jointGapMean = 0;   ///< distance of the anchors of ball and fixed joints [m]
  double jointGapMax = 0;
  double kineticEnergy = 0;    ///< [J]
  double potentialEnergy = 0;  ///< in the gravity of the scene, relative to the origin [J]
  double maxSpeed = 0;         ///< [m/s]
};

}  // namespace rubble
