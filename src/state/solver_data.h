#pragma once
/// All arrays of the engine, declared once with meaning, unit and shape. A SolverData holds pointers and
/// counts only; kernels take it by value.
#include "state/array.h"
#include "state/bodies.h"
#include "state/columns.h"
#include "state/joint_tables.h"
#include "state/kinds.h"
#include "state/trees.h"
#include "state/vertices.h"

namespace rubble::RUBBLE_CORE {

/// Elements between vertices, one array per type.
template <class F> struct ElementTable { Array<F> element = nullptr; };
template <class List> struct ElementTables;
template <class... F> struct ElementTables<TypeList<F...>> : ElementTable<F>... {};

struct SolverData : JointTables<JointTypes>, ElementTables<ElementTypes> {
  int bodies = 0;        ///< slots, including removed ones and a reserve
  int worlds = 1;        ///< separate worlds in the tables
  bool pausing = false;  ///< true: some worlds are left out of this step
  /// True: sums have one order, whatever the number of elements. So a world of a batch has the bits that it
  /// has in a batch of its own on a device, too.
  bool fixedOrder = false;
  bool anyKinds = false;  ///< true: kernels are those for all kinds of constraints, whatever occurs here
  bool searchesAlways = false;  ///< true: neighbors are searched in every step
  int planes = 0;
  int surfaces = 0;                    ///< materials in the shared table
  int materialRules = 0;               ///< rules of pairs of materials
  bool oneWay = false;                 ///< true: some material in the table is one-way
  bool generalShapes = false;          ///< true: some body has a non-primitive shape
  bool rolls = false;                  ///< true: the material of some body has rolling or torsional friction
  bool rolledBefore = false;           ///< `rolls` of the last step
  bool bounces = false;                ///< true: the material of some body has restitution
  int cells = 0;                       ///< buckets of the grid, a power of two
  bool ordered = false;                ///< true: table order differs from id order
  bool bodiesMove = true;              ///< false: no body is dynamic
  int exclusions = 0;                  ///< size of the hash table of excluded pairs; 0: there are none
  bool filtered = false;               ///< true: some body has a collision filter or is a sensor
  bool locked = false;                 ///< true: some body has locked axes
  int joints[JointTypes::kSize] = {};  ///< slots in use per joint type
  int treeNodes = 0;                   ///< slots of nodes of joint trees
  int smallTrees = 0;                  ///< slots of the list of small trees
  int treeLevels = 0;                  ///< elimination levels of the large trees
  int levelBegin[kTreeLevels + 1] = {};  ///< first element of each level in levelNode, and their number
  int treeLimits = 0;                    ///< 1: some joint in a tree has limits
  int vertices = 0;                      ///< slots in use, including removed ones
  int particleCells = 0;  ///< buckets of the grid of granular particles, a power of two; 0: no particles
  Real particleCell = 1;  ///< [m]
  int attachments = 0;    ///< slots in use
  int edges = 0, features = 0;                ///< of colliding surfaces; edges come first, then triangles
  int featureCells = 0;                       ///< buckets of the grid of features, a power of two
  Real featureCell = 1;                       ///< cell size of its finest level [m]
  int clusterBegin[kClusterLevels + 1] = {};  ///< first cluster of each level, finest level first
  int movingParts = 0;  ///< clusters of the finest level that move as one; they come first
  int clusterRefs = 0;
  int softNodes = 0, objects = 0;       ///< soft nodes; those with a cluster come first and number `objects`
  int strands = 0, strandVertices = 0;  ///< cables and rods, and their vertices
  int elements[ElementTypes::kSize] = {},
      yielding = 0;  ///< slots in use per element type; tetrahedra that can yield
  StepPlan plan;
  /// In device memory on a device, so that a captured step outlives them. Kernels that use many copy them,
  /// because loads through the pointer are repeated after every store. The first element holds for all
  /// worlds; what depends on gravity is read from the element of a world (stepOf).
  Array<StepConstants> step = nullptr;
  Counters* counters = nullptr;

  // bodies: authored
  Array<int> idOf = nullptr;     ///< BodyId::index of the body in each table row, in its world
  Array<int> placeOf = nullptr;  ///< table row of the body of each id
  Array<BodyParams> params = nullptr;
  Array<BodyExtras> extras = nullptr;
  Array<BodyFilter> filter = nullptr;
  Array<int> planeBody = nullptr;  ///< body indices of the planes, sorted by world
  Array<ExcludedPair>
      exclusion = nullptr;  ///< hash table of pairs that do not collide (stages/pairs/filter.h)
  // worlds, if there are several. The bodies of a world are consecutive, in the order of their ids, and so
  // are its vertices. Objects of different worlds never meet.
  Array<int> worldOfBody = nullptr;    ///< world of each body
  Array<int> firstBody = nullptr;      ///< [worlds + 1] first body of each world
  Array<int> worldOfVertex = nullptr;  ///< world of each vertex
  Array<int> firstVertex = nullptr;    ///< [worlds + 1] first vertex of each world
  Array<int> firstPlane = nullptr;     ///< [worlds + 1] first plane of each world, in planeBody
  Array<int> paused = nullptr;         ///< 1: the world is left out of this step
  // shapes and materials shared by bodies: authored
  Array<Vec4> shapeVector = nullptr;  ///< see ShapeTables
  Array<int> shapeIndex = nullptr;
  Array<ShapePart> shapePart = nullptr;
  Array<SurfaceData>
      surface = nullptr;  ///< materials with more than two friction coefficients and a restitution
  Array<MaterialRule> materialRule = nullptr;  ///< ascending in world, low and high
  // bodies: state
  Array<Vec3d> position = nullptr;         ///< center of mass [m]
  Array<Quat> orientation = nullptr;       ///< body -> world
  Array<Vec3> velocity = nullptr;          ///< [m/s]
  Array<Vec3> angularVelocity = nullptr;   ///< world axes [rad/s]
  Array<Vec3> previousVelocity = nullptr;  ///< one step earlier [m/s]
  Array<Vec3> force = nullptr;             ///< user force, for one step [N]
  Array<Vec3> torque = nullptr;            ///< user torque, for one step [N m]
  Array<int> pushed = nullptr;             ///< what happened in the last step: LastStep
  Array<Vec3> correction = nullptr;        ///< displacement of the penetration correction in this step [m]
  Array<int> asleep = nullptr;             ///< 1 + the root body of the sleeping island, or 0: awake
  Array<Real> stillTime = nullptr;  ///< time since the body last moved faster than the sleep threshold [s]
  // bodies: work
  Array<Bounds> bounds = nullptr;                  ///< swept AABBs
  Array<int> bucketCount = nullptr;                ///< bodies per bucket
  Array<int> bucketOffset = nullptr;               ///< [cells + 1]
  Array<GridEntry> grid = nullptr;                 ///< bodies sorted by bucket
  Array<CellPaths> cellPaths = nullptr;            ///< bounds of the long paths in each bucket
  Array<int> subcellFirst = nullptr;               ///< 1 + the first body of each bucket of subcells; 0: none
  Array<int> subcellNext = nullptr;                ///< 1 + the next one after a body; 0: none
  Array<int> pairSlot = nullptr;                   ///< [bodies][kPairSlots] neighbors of the last search
  Array<NeighborSearch> neighborSearch = nullptr;  ///< the last search of each body
  Array<int> searcher = nullptr;                   ///< bodies that search, in no fixed order, unless all do
  Array<int> crowdedBody = nullptr;       ///< those with more neighbors than slots, in no fixed order
  Array<int> pairCount = nullptr;         ///< pairs that the body owns
  Array<int> impactSpeedBound = nullptr;  ///< bound of the speed that an impact may give the body in this
                                          ///< step, as the bits of a float [m/s]
  Array<BodyTarget> target = nullptr;     ///< inertial target
  Array<Displacement> dx = nullptr;       ///< x - x^t at the present iterate
  Array<Quat> dq = nullptr;               ///< rotation since x^t at the present iterate, q (q^t)^-1
  Array<int> island = nullptr;            ///< root body of the island
  Array<int> islandFlag = nullptr;        ///< at the root body: 1 if the island wakes or stays awake
  Array<int> rowIsland = nullptr;         ///< lowest body connected to this one by rows of this step
  Array<int> islandBonds = nullptr;  ///< flags of the rows that act on the body, or on the island at its root
                                     ///< (stages/islands/island_momentum.h)
  Array<int> islandMassLength = nullptr;  ///< mass times length of the heaviest body of its island in the
                                          ///< last step, as the bits of a float; 0: unknown [kg m]
  Array<int> islandSlot = nullptr;  ///< at a root body: index of its island in the next two arrays, or -1
  Array<IslandSums> islandSums = nullptr;
  Array<IslandRepair> islandRepair = nullptr;
  Array<int> fast = nullptr;  ///< 1: CCD candidate: moves further than its thickness, or is pressed into a
                              ///< rigid surface; kSearched: it is in searchedBody, too
  Array<int> fastBody = nullptr;      ///< CCD: the candidates, in no fixed order
  Array<int> searchedBody = nullptr;  ///< CCD: those that search for others without a pair, in no fixed order
  Array<int> nearSurface = nullptr;   ///< 1: its corners may touch the surface of a deformable object
  Array<int> ccdShareBits = nullptr;  ///< CCD: share of the motion that is cut off, as the bits of a float
  Array<int> ccdSeenBits = nullptr;  ///< CCD: ccdShareBits as of the present round; for jointed bodies stored
                                     ///< at the root of their CCD island
  Array<int> ccdRound = nullptr;     ///< CCD: round in which that last changed, or kOwnImpact
  Array<int> ccdPair = nullptr;      ///< CCD: 1 + the pair that stops the body, or 0
  Array<int> ccdCarrier = nullptr;  ///< CCD: who carries it (stages/ccd/carriers.h), or 0; for jointed bodies
                                    ///< stored at the root of their CCD island
  Array<int> ccdRunInto = nullptr;  ///< CCD: 1 + a body that runs into it where it has stopped, or 0
  Array<Displacement> ccdMotion = nullptr;   ///< CCD: motion after the cut
  Array<int> bounceBody = nullptr;           ///< restitution state of the body: BounceBody
  Array<BodyMotion> bounceMotion = nullptr;  ///< solved velocities, before restitution
  Array<Vec3> nextCorrection = nullptr;      ///< `correction` of the next step [m]
  Array<int> color = nullptr;                ///< kept between steps
  Array<int> nextColor = nullptr;            ///< new color of the bodies in `clashing`
  Array<int>
      clashing = nullptr;  ///< bodies and vertices (kVertexNode + index) that need a new color in this step
  Array<int> colorBody = nullptr;        ///< dynamic bodies sorted by color
  Array<int> incidenceCount = nullptr;   ///< constraints on the body
  Array<int> incidenceOffset = nullptr;  ///< [bodies + 1]
  // Aggregates. Their nodes are bodies and, numbered from `bodies` on, soft nodes. Arrays over (level, node)
  // have index level * nodes() + node.
  Array<int> root = nullptr;       ///< [level][node] parent in the union-find forest
  Array<int> nodeCount = nullptr;  ///< [level][node] at a root: nodes of its aggregate
  Array<int> isRoot = nullptr;     ///< [level][node] 1: root of an aggregate of two or more nodes
  Array<int>
      aggregateIndex = nullptr;  ///< [level][node] at a root: number of its aggregate, coarsest level last
  Array<int> aggregateOf = nullptr;    ///< [level][node] aggregate of the node; -1: none
  Array<int> aggregateNode = nullptr;  ///< nodes sorted by aggregate, ascending
  Array<Aggregate> aggregate = nullptr;
  Array<int> aggregateOffset = nullptr;  ///< [aggregates + 1] into aggregateNode
  Array<int> aggregateSlices = nullptr;  ///< number of slices of each aggregate
  Array<int> sliceOffset = nullptr;      ///< [aggregates + 1]
  Array<Slice> slice = nullptr;
  Array<int>
      boundaryCount = nullptr;  ///< constraints between bodies of the slice and bodies outside its aggregate
  Array<int> boundaryOffset = nullptr;           ///< [slices + 1]
  Array<BoundaryConstraint> boundary = nullptr;  ///< sorted by slice
  Array<int> levelAggregate = nullptr;           ///< [levels + 1] first aggregate of a level
  Array<int> levelSlice = nullptr;               ///< [levels + 1] first slice of a level
  // columns
  Array<ColumnLinks> columnLinks = nullptr;
  Array<int> columnCount = nullptr;   ///< at one end of a column: number of its bodies
  Array<int> columnOffset = nullptr;  ///< [bodies + 1] into columnNode
  Array<int> columnLength = nullptr;  ///< number of bodies of the column that a body belongs to; 0: none
  Array<ColumnNode> columnNode = nullptr;
  Array<ColumnWork> columnWork = nullptr;
  // joint trees: derived, and work
  Array<int> nodeOfBody = nullptr;  ///< tree node of each body; -1: none
  Array<TreeNode> treeNode = nullptr;
  Array<int> nodeLevel = nullptr;  ///< elimination level of each node
  Array<int> treeChild = nullptr;  ///< 2 * node + side of its coupling, sorted by parent
  Array<SmallTree> smallTree = nullptr;
  Array<int> levelNode = nullptr;  ///< nodes of the large trees, sorted by level
  Array<TreeWork> treeWork = nullptr;
  Array<int> treeContacts = nullptr;     ///< what touches the tree in this step (state/trees.h)
  Array<int> treeConverged = nullptr;    ///< by tree: 1: this solve leaves it unchanged
  Array<int> treeMaxRotation = nullptr;  ///< by tree: largest rotation of its Newton step, as the bits of a
                                         ///< float [rad]
  Array<int> treeNeedsProjection = nullptr;  ///< by tree: 1: a joint is open at the end of the step
  Array<ProjectionLink> projectionLink = nullptr;
  // colors
  Array<int> colorCount = nullptr;   ///< bodies of each color
  Array<int> colorOffset = nullptr;  ///< [colors + 1]
  // pairs
  Array<int> pairOffset = nullptr;  ///< [bodies + 1] first pair owned by a body
  Array<int> oldPairOffset = nullptr;
  Array<Pair> pair = nullptr;  ///< sorted by owner, then by partner
  Array<Pair> oldPair = nullptr;
  Array<PairTest> pairTest = nullptr;  ///< the last full test of each pair
  Array<PairTest> oldPairTest = nullptr;
  Array<int> manifoldBefore = nullptr;    ///< manifold of the pair in the last step; -1: none
  Array<int> newPair = nullptr;           ///< pairs without data from the last step
  Array<int> isActive = nullptr;          ///< 1: points of the pair may be active in this step
  Array<int> activePairOffset = nullptr;  ///< [pairs + 1] number of active pairs before this one
  Array<int> oldActivePairOffset = nullptr;
  Array<int> activePair = nullptr;     ///< indices of the active pairs
  Array<Manifold> manifold = nullptr;  ///< one per active pair
  Array<Manifold> oldManifold = nullptr;
  Array<SweptPair> sweptPair = nullptr;  ///< CCD: pairs of fast bodies, in no fixed order
  Array<int> tested = nullptr;           ///< manifolds that need a full narrow-phase test
  Array<int> hasRows = nullptr;          ///< 1: a point of the manifold is active in this step
  Array<RollingRows> rolling = nullptr;  ///< one per manifold, if `rolls`
  Array<RollingRows> oldRolling = nullptr;
  Array<int> rowOffset = nullptr;  ///< [activePairs + 1] number of manifolds with rows before this one
  // rows
  Array<ContactRows> contact = nullptr;  ///< one per manifold with rows, in the order of manifolds; aliases
                                         ///< the old manifolds (SolverTables::aliasRows)
  Array<Bounce> bounce = nullptr;    ///< one per element of `contact`, if restitution may act in this step
  Array<Support> support = nullptr;  ///< one per element of `contact`
  Array<RowBodies> rowBodies = nullptr;  ///< one per element of `contact`
  Array<int> joinLevel = nullptr;  ///< per element of `contact`: aggregate level that unites its bodies;
                                   ///< kCoarseLevels: none; or kNoTouch
  Array<Incidence> incidence = nullptr;  ///< constraints sorted by body

  // vertices: authored
  Array<VertexParams> vertexParams = nullptr;
  Array<int> refOffset = nullptr;            ///< [vertices + 1] into ref
  Array<std::uint32_t> ref = nullptr;        ///< elements of each vertex except tetrahedra, then attachments
  Array<int> tetraCornerOffset = nullptr;    ///< [vertices + 1] into tetraCorner
  Array<TetraCorner> tetraCorner = nullptr;  ///< tetrahedra of each vertex
  Array<Sym3> cornerStart = nullptr;         ///< their E^t in this step; 0 without viscosity
  Array<int> neighborOffset = nullptr;       ///< [vertices + 1] into neighbor
  Array<int> neighbor = nullptr;  ///< vertices that share an element or attachment with this one, sorted
  // vertices: state
  Array<Vec3d> vertexPosition = nullptr;    ///< [m]
  Array<Vec3> vertexVelocity = nullptr;     ///< [m/s]
  Array<Vec3> vertexOldVelocity = nullptr;  ///< one step earlier [m/s]
  Array<Vec3> vertexForce = nullptr;        ///< user force, for one step [N]
  Array<int> vertexColor = nullptr;
  // vertices: work
  Array<Vec3> vertexTarget = nullptr;  ///< y - x^t [m]
  Array<Vec3> vertexMoved = nullptr;   ///< x - x^t, present iterate [m]
  Array<VertexIterates> vertexIterates = nullptr;
  Array<PaddedVec3> vertexPlace = nullptr;  ///< x relative to the first vertex of its object at x^t [m]
  Array<int> vertexNextColor = nullptr;
  Array<int> colorVertex = nullptr;     ///< dynamic vertices sorted by color
  Array<int> particleCount = nullptr;   ///< granular particles per bucket
  Array<int> particleOffset = nullptr;  ///< [particleCells + 1]
  Array<BoxEntry> particle = nullptr;   ///< granular particles sorted by bucket
  // pairs owned by vertices and edges
  Array<int> pointPairSlot = nullptr;    ///< [owners][kPointPairSlots] partners found by the broad phase
  Array<int> pointPairCount = nullptr;   ///< pairs that a vertex or edge owns
  Array<int> pointPairOffset = nullptr;  ///< [owners + 1] first pair of an owner
  Array<int> oldPointPairOffset = nullptr;
  // surfaces
  Array<SurfaceFeature> feature = nullptr;  ///< authored
  Array<Vec3> vertexRest = nullptr;  ///< authored: rest shape, relative to the first vertex of the object [m]
  Array<int> featureCount = nullptr;       ///< features per bucket
  Array<int> featureOffset = nullptr;      ///< [featureCells + 1]
  Array<BoxEntry> featureEntry = nullptr;  ///< features sorted by bucket
  Array<VertexRepair> vertexRepair = nullptr;
  Array<int> crossingRound = nullptr;         ///< by world: 1 + the last round that found an impact
  Array<NearFeature> nearFeature = nullptr;   ///< sorted by owner; in no fixed order within one
  Array<int> nearCount = nullptr;             ///< elements of nearFeature per vertex and edge
  Array<int> nearOffset = nullptr;            ///< [owners + 1]
  Array<int> pointIncidenceCount = nullptr;   ///< contacts of a vertex
  Array<int> pointIncidenceOffset = nullptr;  ///< [vertices + 1]
  Array<int> vertexColorCount = nullptr;      ///< vertices of each color
  Array<int> vertexColorOffset = nullptr;     ///< [colors + 1]
  // pairs of vertices with bodies and with one another, and their rows
  Array<PointPair> pointPair = nullptr;  ///< sorted by owner, then by partner
  Array<PointPair> oldPointPair = nullptr;
  Array<PointContact> pointContact = nullptr;  ///< one per pair
  Array<PointContact> oldPointContact = nullptr;
  Array<std::uint32_t> pointIncidence = nullptr;  ///< contacts sorted by vertex
  // clusters
  Array<Cluster> cluster = nullptr;    ///< sorted by level
  Array<int> clusterMember = nullptr;  ///< dynamic vertices of objects with elements, sorted by cluster
  Array<ClusterRef>
      clusterRef = nullptr;  ///< elements that cross the boundary of a cluster, sorted by cluster
  Array<ClusterMotion> clusterMotion = nullptr;
  Array<SoftNode> softNode = nullptr;   ///< objects, then granular particles
  Array<Block3> softNodeSum = nullptr;  ///< force and Hessian of a soft node in its aggregate
  Array<Strand> strand = nullptr;
  Array<StrandVertex> strandVertex = nullptr;  ///< sorted by strand, from one end to the other
  Array<StrandWork> strandWork = nullptr;
  Array<Real> strandShare = nullptr;  ///< share of the Newton step that the strand takes [1]
  // attachments; elements are in ElementTables
  Array<Attachment> attachment = nullptr;

  /// Number of nodes that aggregates are made of.
  RUBBLE_HD int nodes() const { return bodies + softNodes; }
  RUBBLE_HD int jointSlots() const {
    int all = 0;
    for (const int n : joints) all += n;
    return all;
  }
  RUBBLE_HD bool hasJoints() const { return jointSlots() > 0; }
  /// Number of possible owners of vertex pairs: every vertex, every edge and, if there is a surface, the
  /// corner slots of every body.
  RUBBLE_HD int owners() const;
  RUBBLE_HD ShapeTables shapeTables() const { return {shapeVector, shapeIndex, shapePart}; }
  /// World of a body; of kWorldBody: the first one.
  RUBBLE_HD int worldOf(int body) const { return worlds > 1 && body >= 0 ? worldOfBody[body] : 0; }
  RUBBLE_HD int worldOfPoint(int vertex) const { return worlds > 1 ? worldOfVertex[vertex] : 0; }
  /// The constants of a step in the world of a body or a vertex.
  RUBBLE_HD const StepConstants& stepOf(int body) const { return step[worldOf(body)]; }
  RUBBLE_HD const StepConstants& stepOfPoint(int vertex) const { return step[worldOfPoint(vertex)]; }
  /// The same of a constraint between two bodies, one of which may be the world.
  RUBBLE_HD const StepConstants& stepOf(int a, int b) const { return stepOf(a >= 0 ? a : b); }
  /// Number of a vertex within its world.
  RUBBLE_HD int numberOfPoint(int vertex) const {
    return worlds > 1 ? vertex - firstVertex[worldOfVertex[vertex]] : vertex;
  }
  /// The bodies of a world.
  RUBBLE_HD int bodiesBegin(int world) const { return worlds > 1 ? firstBody[world] : 0; }
  RUBBLE_HD int bodiesEnd(int world) const { return worlds > 1 ? firstBody[world + 1] : bodies; }
  /// The planes of a world: range in planeBody.
  RUBBLE_HD int planesBegin(int world) const { return worlds > 1 ? firstPlane[world] : 0; }
  RUBBLE_HD int planesEnd(int world) const { return worlds > 1 ? firstPlane[world + 1] : planes; }

  template <class F> RUBBLE_HD F* elementsOf() const { return ElementTable<F>::element; }
  template <class F> RUBBLE_HD JointSpec<F>* specsOf() const { return JointTable<F>::spec; }
  template <class F> RUBBLE_HD Joint<F>* jointsOf() const { return JointTable<F>::joint; }
  template <class F> RUBBLE_HD TreeRows<F>* treeRowsOf() const { return JointTable<F>::treeRows; }
  template <class F> RUBBLE_HD JointAngularRows<F>* angularRowsOf() const {
    return JointTable<F>::angularRows;
  }
};

/// SolverData::owners() with another number of bodies.
RUBBLE_HD inline int ownersOf(const SolverData& s, int bodies) {
  return s.vertices + s.edges + (s.features > 0 ? kCornerSlots * bodies : 0);
}

RUBBLE_HD inline int SolverData::owners() const { return ownersOf(*this, bodies); }

/// Slots in use of an element type; 0 for other kinds.
inline std::size_t elementCount(const SolverData& s, Per per) {
  const int type = static_cast<int>(per) - static_cast<int>(Per::FirstElement);
  return type >= 0 && type < ElementTypes::kSize ? static_cast<std::size_t>(s.elements[type]) : 0;
}

/// Wakes an edited body. Its island wakes with it in the next step, because an awake neighbor wakes an
/// island.
RUBBLE_HD inline void wakeBody(const SolverData& s, int body) {
  s.asleep[body] = 0;
  s.stillTime[body] = 0;
}
RUBBLE_HD inline bool isPaused(const SolverData& s, int body) {
  return s.pausing && s.paused[s.worldOf(body)] != 0;
}
/// A body of a paused world counts as asleep.
RUBBLE_HD inline bool isAsleep(const SolverData& s, int body) {
  return (s.plan.sleeping && s.asleep[body] != 0) || isPaused(s, body);
}
RUBBLE_HD inline bool isPausedPoint(const SolverData& s, int vertex) {
  return s.pausing && s.paused[s.worldOfPoint(vertex)] != 0;
}
/// Number of bodies of the column that a body belonged to in the last step; 0: none.
RUBBLE_HD inline int columnBefore(const SolverData& s, int body) { return s.pushed[body] >> kColumnShift; }
/// Is the body moved by the solver? A sleeping body counts as static.
RUBBLE_HD inline bool isDynamic(const SolverData& s, int body) {
  return body != kWorldBody && s.params[body].kind == BodyKind::Dynamic && !isAsleep(s, body);
}

}  // namespace rubble::RUBBLE_CORE
