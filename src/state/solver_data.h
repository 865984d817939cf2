#pragma once
/// Every array of the engine, declared once: meaning, unit, shape and who writes it. A SolverData is handed
/// to each kernel by value.
#include "state/bodies.h"
#include "state/joint_tables.h"
#include "state/kinds.h"
#include "state/trees.h"
#include "state/vertices.h"

namespace rubble::RUBBLE_CORE {

struct SolverData : JointTables<JointTypes> {
  int bodies = 0;  ///< slots in use, removed ones included
  int planes = 0;
  int shapeVectors = 0, shapeIndices = 0, shapeParts = 0,
      surfaces = 0;                    ///< elements of the shared tables in use
  bool generalShapes = false;          ///< some body is not of a plain kind
  bool rolls = false;                  ///< the material of some body has rolling or torsional friction
  bool rolledBefore = false;           ///< it did in the last step
  bool bounces = false;                ///< that of some body has restitution
  int cells = 0;                       ///< buckets of the grid, a power of two
  bool ordered = false;                ///< some body is at another place than its id
  bool bodiesMove = true;              ///< false: it is known that no body is dynamic
  int exclusions = 0;                  ///< pairs of bodies that are excluded
  bool filtered = false;               ///< some body has a filter or is a sensor
  int wakeAll = 0;                     ///< 1: nothing sleeps on in this step
  bool locked = false;                 ///< some body has locked axes
  int joints[JointTypes::kSize] = {};  ///< slots in use of each type
  int treeBegin[kTreeLevels + 1] =
      {};  ///< first node of each round of elimination; the last one: how many there are
  int treeLevels = 0;
  int treeChildren = 0;
  int trees = 0;
  bool smallTrees = false;  ///< none has more than kSmallTree bodies
  int treeLimits = 0;       ///< 1: some tree has limits
  int treesStale = 1;       ///< 1: bodies or joints were edited since the trees were found
  int vertices = 0;         ///< slots in use, removed ones included
  int particleCells = 0;    ///< buckets of the grid of granular particles, a power of two; 0: there are none
  Real particleCell = 1;    ///< [m]
  int attachments = 0;      ///< slots in use
  int edges = 0, features = 0;                ///< of surfaces that collide: edges come first, then triangles
  int featureCells = 0;                       ///< buckets of their grid, a power of two
  Real featureCell = 1;                       ///< cells of its finest level [m]
  int clusterBegin[kClusterLevels + 1] = {};  ///< first cluster of each level, fine ones first
  int movingParts = 0;  ///< clusters of the finest level that move as one: they come first
  int clusterRefs = 0;
  int softNodes = 0, objects = 0;       ///< those with a cluster come first, and are so many
  int strands = 0, strandVertices = 0;  ///< ropes and rods, and their vertices
  int elements[ElementTypes::kSize] = {},
      yielding = 0;  ///< slots in use of each type; tetrahedra that can yield
  StepConstants step{};
  Counters* counters = nullptr;

  // bodies: authored
  int* idOf = nullptr;     ///< BodyId::index of the body at each place in these tables
  int* placeOf = nullptr;  ///< and the place of the body of each id
  BodyParams* params = nullptr;
  BodyExtras* extras = nullptr;
  BodyFilter* filter = nullptr;
  int* planeBody = nullptr;        ///< indices of the planes
  int* exclusionOffset = nullptr;  ///< [bodies + 1], by id, into exclusionBody
  int* exclusionBody = nullptr;    ///< ids that this one does not collide with (higher ones), sorted
  // shapes and materials that bodies share: authored
  Vec4* shapeVector = nullptr;  ///< see ShapeTables
  int* shapeIndex = nullptr;
  ShapePart* shapePart = nullptr;
  SurfaceData* surface = nullptr;  ///< materials that are more than two frictions and a restitution
  // bodies: state
  Vec3d* position = nullptr;         ///< centre of mass [m]
  Quat* orientation = nullptr;       ///< body -> world
  Vec3* velocity = nullptr;          ///< [m/s]
  Vec3* angularVelocity = nullptr;   ///< world axes [rad/s]
  Vec3* previousVelocity = nullptr;  ///< one step earlier [m/s]
  Vec3* force = nullptr;             ///< applied by the user, for one step [N]
  Vec3* torque = nullptr;            ///< [N m]
  int* pushed = nullptr;             ///< 1: a force acted in the last step
  Vec3* correction = nullptr;  ///< how far the correction of penetrations below moves a body in a step [m]
  int* asleep = nullptr;       ///< 1 + a body that stands for the island that sleeps, 0: awake
  Real* stillTime = nullptr;   ///< for how long a body has been still [s]
  // bodies: work
  Bounds* bounds = nullptr;         ///< by Bounds stage
  int* bucketCount = nullptr;       ///< bodies of each bucket
  int* bucketOffset = nullptr;      ///< [cells + 1]
  GridEntry* grid = nullptr;        ///< bodies by bucket
  int* pairSlot = nullptr;          ///< [bodies][kPairSlots] partners found
  int* pairCount = nullptr;         ///< pairs that a body owns
  int* impactSpeedBound = nullptr;  ///< speed that a neighbour may give a body in this step, as the bits of a
                                    ///< float [m/s]
  BodyTarget* target = nullptr;     ///< inertial target
  Displacement* dx = nullptr;       ///< x - x^t, present iterate
  Quat* dq = nullptr;               ///< its rotation, q (q^t)^-1
  int* island = nullptr;            ///< a body that stands for the island
  int* islandFlag = nullptr;        ///< of that body: 1 if the island wakes, or does not sleep
  int* rowIsland = nullptr;         ///< lowest body that rows of this step connect with it
  int* islandBonds = nullptr;       ///< bits of what rows do with it, or with the island that it leads
                                    ///< (stages/islands/island_momentum.h)
  int* islandMassLength = nullptr;  ///< of the heaviest body of its island in the last step, as the bits of a
                                    ///< float, 0: not known [kg m]
  int* islandSlot = nullptr;        ///< place of the island that it leads in these two, -1: none
  IslandSums* islandSums = nullptr;
  IslandRepair* islandRepair = nullptr;
  int* fast = nullptr;         ///< 1: went further than it is thick, or is pressed into what does not yield
  int* nearSurface = nullptr;  ///< 1: its corners may touch the surface of a deformable object
  int* stopBits = nullptr;  ///< part of the way that a body does not make since it meets another, as the bits
                            ///< of a float
  int* stopSeen = nullptr;  ///< stopBits as far as the present round knows them; of bodies that joints hold
                            ///< together: with their leader
  int* stopRound = nullptr;            ///< round in which that changed, or kHasMet
  int* stopPair = nullptr;             ///< 1 + the pair that it stops at, or 0
  Displacement* ccdMotion = nullptr;   ///< the way that it makes then
  int* bounceBody = nullptr;           ///< part of a body in impacts: BounceBody
  BodyMotion* bounceMotion = nullptr;  ///< its velocities before they were taken back
  Vec3* nextCorrection = nullptr;      ///< correction as this step finds it [m]
  int* color = nullptr;                ///< kept from step to step
  int* nextColor = nullptr;            ///< of the bodies that choose one
  int* clashing = nullptr;  ///< bodies, and vertices (kVertexNode + index), that choose a colour in this step
  int* colorBody = nullptr;        ///< dynamic bodies by colour
  int* incidenceCount = nullptr;   ///< row blocks of a body
  int* incidenceOffset = nullptr;  ///< [bodies + 1]
  // aggregates, whose nodes are bodies and, numbered from `bodies` on, soft nodes; arrays over (level, node)
  // have index level * nodes() + node
  int* root = nullptr;            ///< [level][node] forest of aggregates being united
  int* nodeCount = nullptr;       ///< [level][node] nodes of the aggregate that the node is the root of
  int* isRoot = nullptr;          ///< [level][node] 1: is the root of an aggregate of two or more
  int* aggregateIndex = nullptr;  ///< [level][node] its number, coarse levels last
  int* aggregateOf = nullptr;     ///< [level][node] its aggregate, -1: alone
  int* aggregateNode = nullptr;   ///< by aggregate, ascending
  Aggregate* aggregate = nullptr;
  int* aggregateOffset = nullptr;  ///< [aggregates + 1] into node
  int* aggregateSlices = nullptr;  ///< slices of each aggregate
  int* sliceOffset = nullptr;      ///< [aggregates + 1]
  Slice* slice = nullptr;
  int* boundaryCount = nullptr;       ///< row blocks between a slice's bodies and others
  int* boundaryOffset = nullptr;      ///< [slices + 1]
  std::uint32_t* boundary = nullptr;  ///< incidence codes by slice
  int* levelAggregate = nullptr;      ///< [levels + 1] first aggregate of a level
  int* levelSlice = nullptr;          ///< [levels + 1] first slice of a level
  // trees of joints: derived, and work
  int* nodeOfBody = nullptr;     ///< of each body, -1: none
  TreeNode* treeNode = nullptr;  ///< by round
  int* treeOffset = nullptr;     ///< [trees + 1]
  int* treeMember = nullptr;     ///< nodes by tree, then by round
  int* treeChild = nullptr;  ///< 2 * node + side of its coupling, by the node that it passes something on to
  TreeWork* treeWork = nullptr;
  int* treeContacts = nullptr;         ///< what touches the tree in this step (state/trees.h)
  int* treeConverged = nullptr;        ///< by tree: it stays as it is in this solve
  int* treeMaxRotation = nullptr;      ///< largest rotation of a tree's step, as the bits of a float [rad]
  int* treeNeedsProjection = nullptr;  ///< 1: a joint of the tree is open at the end of the step
  ProjectionLink* projectionLink = nullptr;
  // colours
  int* colorCount = nullptr;   ///< bodies of each colour
  int* colorOffset = nullptr;  ///< [colors + 1]
  // pairs
  int* pairOffset = nullptr;  ///< [bodies + 1] first pair of a body
  int* oldPairOffset = nullptr;
  Pair* pair = nullptr;  ///< by owner, then by partner
  Pair* oldPair = nullptr;
  PairTest* pairTest = nullptr;  ///< the last full test of each pair
  PairTest* oldPairTest = nullptr;
  int* manifoldBefore = nullptr;    ///< that a pair had in the step before, -1: none
  int* newPair = nullptr;           ///< pairs of which nothing is known yet
  int* isActive = nullptr;          ///< 1 if points of the pair may take part in the step
  int* activePairOffset = nullptr;  ///< [pairs + 1] near pairs before this one
  int* oldActivePairOffset = nullptr;
  int* activePair = nullptr;     ///< the pairs that are near
  Manifold* manifold = nullptr;  ///< one a near pair
  Manifold* oldManifold = nullptr;
  int* toiBits = nullptr;  ///< part of the way that is left when its bodies meet, as the bits of a float; 0:
                           ///< never
  int* tested = nullptr;   ///< manifolds whose narrow phase is run anew
  int* hasRows = nullptr;  ///< 1 if a point of the manifold takes part in the step
  RollingRows* rolling = nullptr;  ///< one a manifold, if rolls
  RollingRows* oldRolling = nullptr;
  int* rowOffset = nullptr;  ///< [near pairs + 1] manifolds with rows before this one
  // rows
  ContactRows* contact = nullptr;  ///< one a manifold that has rows, in the order of manifolds; where the old
                                   ///< manifolds were (SolverTables::aliasRows)
  Bounce* bounce = nullptr;        ///< one for each of them, if something may bounce in the step
  Support* support = nullptr;      ///< one a manifold that has rows
  int* joinLevel = nullptr;  ///< level of the groups at which they unite their bodies, kCoarseLevels: at none
  Incidence* incidence = nullptr;  ///< row blocks by body

  // vertices: authored
  VertexParams* vertexParams = nullptr;
  int* refOffset = nullptr;            ///< [vertices + 1] into ref
  std::uint32_t* ref = nullptr;        ///< elements of each vertex but tetrahedra, then attachments
  int* tetraCornerOffset = nullptr;    ///< [vertices + 1] into tetraCorner
  TetraCorner* tetraCorner = nullptr;  ///< tetrahedra of each vertex
  Sym3* cornerStart = nullptr;         ///< their E^t in this step, 0 without viscosity
  int* neighborOffset = nullptr;       ///< [vertices + 1] into neighbor
  int* neighbor = nullptr;             ///< vertices that share an element or attachment with this one, sorted
  // vertices: state
  Vec3d* vertexPosition = nullptr;    ///< [m]
  Vec3* vertexVelocity = nullptr;     ///< [m/s]
  Vec3* vertexOldVelocity = nullptr;  ///< one step earlier [m/s]
  Vec3* vertexForce = nullptr;        ///< applied by the user, for one step [N]
  int* vertexColor = nullptr;
  // vertices: work
  Vec3* vertexTarget = nullptr;  ///< y - x^t [m]
  Vec3* vertexMoved = nullptr;   ///< x - x^t, present iterate [m]
  PastVertex* pastVertex = nullptr;
  PaddedVec3* vertexPlace = nullptr;  ///< x from the first vertex of its object at x^t, present iterate [m]
  int* vertexNextColor = nullptr;
  int* colorVertex = nullptr;     ///< dynamic vertices by colour
  int* particleCount = nullptr;   ///< granular particles of each bucket
  int* particleOffset = nullptr;  ///< [particleCells + 1]
  BoxEntry* particle = nullptr;   ///< granular particles by bucket
  // vertices and edges as owners of pairs
  int* pointPairSlot = nullptr;    ///< [owners][kPointPairSlots] partners found
  int* pointPairCount = nullptr;   ///< pairs that a vertex or edge owns
  int* pointPairOffset = nullptr;  ///< [owners + 1] first pair of an owner
  int* oldPointPairOffset = nullptr;
  // surfaces
  SurfaceFeature* feature = nullptr;  ///< authored
  Vec3* vertexRest = nullptr;         ///< authored: shape at rest, from the first vertex of the object [m]
  int* featureCount = nullptr;        ///< features of each bucket
  int* featureOffset = nullptr;       ///< [featureCells + 1]
  BoxEntry* featureEntry = nullptr;   ///< features by bucket
  VertexRepair* vertexRepair = nullptr;
  NearFeature* nearFeature = nullptr;   ///< by owner, in no fixed order
  int* nearCount = nullptr;             ///< of each vertex and edge
  int* nearOffset = nullptr;            ///< [owners + 1]
  int* pointIncidenceCount = nullptr;   ///< contacts of a vertex
  int* pointIncidenceOffset = nullptr;  ///< [vertices + 1]
  int* vertexColorCount = nullptr;      ///< vertices of each colour
  int* vertexColorOffset = nullptr;     ///< [colors + 1]
  // pairs of vertices with bodies and with one another, and their rows
  PointPair* pointPair = nullptr;  ///< by vertex, then by partner
  PointPair* oldPointPair = nullptr;
  PointContact* pointContact = nullptr;  ///< one a pair
  PointContact* oldPointContact = nullptr;
  std::uint32_t* pointIncidence = nullptr;  ///< contacts by vertex
  // clusters
  Cluster* cluster = nullptr;        ///< by level
  int* clusterMember = nullptr;      ///< dynamic vertices of objects with elements, by cluster
  ClusterRef* clusterRef = nullptr;  ///< elements that leave a cluster, by cluster
  ClusterMotion* clusterMotion = nullptr;
  SoftNode* softNode = nullptr;   ///< objects, then granular particles
  Block3* softNodeSum = nullptr;  ///< force and Hessian of a soft node as its group sees it
  Strand* strand = nullptr;
  StrandVertex* strandVertex = nullptr;  ///< by line, from one end to the other
  StrandWork* strandWork = nullptr;
  Real* strandShare = nullptr;  ///< of the step of a line that it makes [1]
  // elements
  Attachment* attachment = nullptr;
  Tetrahedron* tetrahedron = nullptr;
  Membrane* membrane = nullptr;
  FlatBend* flatBend = nullptr;
  FoldBend* foldBend = nullptr;
  LineBend* lineBend = nullptr;
  Spring* spring = nullptr;
  Pressure* pressure = nullptr;

  template <class F> RUBBLE_HD F* elementsOf() const {
    if constexpr (std::is_same_v<F, Tetrahedron>)
      return tetrahedron;
    else if constexpr (std::is_same_v<F, Membrane>)
      return membrane;
    else if constexpr (std::is_same_v<F, FlatBend>)
      return flatBend;
    else if constexpr (std::is_same_v<F, FoldBend>)
      return foldBend;
    else if constexpr (std::is_same_v<F, LineBend>)
      return lineBend;
    else if constexpr (std::is_same_v<F, Spring>)
      return spring;
    else
      return pressure;
  }
  /// What may be in a group.
  RUBBLE_HD int nodes() const { return bodies + softNodes; }
  RUBBLE_HD int jointSlots() const {
    int all = 0;
    for (const int n : joints) all += n;
    return all;
  }
  RUBBLE_HD bool hasJoints() const { return jointSlots() > 0; }
  /// What owns pairs of vertices: every vertex, every edge, then corners of every body, if there is a
  /// surface.
  RUBBLE_HD int owners() const { return vertices + edges + (features > 0 ? kCornerSlots * bodies : 0); }
  RUBBLE_HD ShapeTables shapeTables() const { return {shapeVector, shapeIndex, shapePart}; }

  template <class F> RUBBLE_HD JointSpec<F>* specsOf() const { return JointTable<F>::spec; }
  template <class F> RUBBLE_HD Joint<F>* jointsOf() const { return JointTable<F>::joint; }
  template <class F> RUBBLE_HD TreeRows<F>* treeRowsOf() const { return JointTable<F>::treeRows; }
  template <class F> RUBBLE_HD JointAngularRows<F>* angularRowsOf() const {
    return JointTable<F>::angularRows;
  }
};

/// Slots in use of a type of element, 0 for other kinds.
inline std::size_t elementCount(const SolverData& s, Per per) {
  const int type = static_cast<int>(per) - static_cast<int>(Per::FirstElement);
  return type >= 0 && type < ElementTypes::kSize ? static_cast<std::size_t>(s.elements[type]) : 0;
}

/// Bodies that are solved by trees.
RUBBLE_HD inline int treeNodes(const SolverData& s) { return s.treeBegin[kTreeLevels]; }

/// What is edited does not sleep on; its island wakes with it, for it is a moving neighbour of the others.
RUBBLE_HD inline void wakeBody(const SolverData& s, int body) {
  s.asleep[body] = 0;
  s.stillTime[body] = 0;
}
RUBBLE_HD inline bool isAsleep(const SolverData& s, int body) {
  return s.step.sleeping && s.asleep[body] != 0;
}
/// Does the step move it by its forces? Bodies that sleep are like static ones.
RUBBLE_HD inline bool isDynamic(const SolverData& s, int body) {
  return body != kWorldBody && s.params[body].kind == BodyKind::Dynamic && !isAsleep(s, body);
}

}  // namespace rubble::RUBBLE_CORE
