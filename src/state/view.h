#pragma once
/// Every array of the engine, declared once: meaning, unit, shape and who writes it. A View is handed to each kernel by value.
#include "state/bodies.h"
#include "state/joint_tables.h"
#include "state/kinds.h"
#include "state/trees.h"
#include "state/vertices.h"

namespace rubble::RUBBLE_CORE {

struct View : JointTables<JointTypes> {
  int bodies = 0;                     ///< slots in use, removed ones included
  int planes = 0;
  int shapeVectors = 0, shapeIndices = 0, shapeParts = 0, surfaces = 0;  ///< elements of the shared tables in use
  bool rareShapes = false;            ///< some body is not of a plain kind
  bool rolls = false;                 ///< the material of some body has rolling or torsional friction
  bool rolledBefore = false;          ///< it did in the last step
  bool bounces = false;               ///< that of some body has restitution
  int cells = 0;                      ///< buckets of the grid, a power of two
  bool ordered = false;               ///< some body is at another place than its id
  bool bodiesMove = true;             ///< false: it is known that no body is dynamic
  int exclusions = 0;                 ///< pairs of bodies that are excluded
  bool filtered = false;              ///< some body has a filter or is a sensor
  int wakeAll = 0;                    ///< 1: nothing sleeps on in this step
  bool locked = false;                ///< some body has locked axes
  int joints[JointTypes::kSize] = {}; ///< slots in use of each type
  int treeBegin[kTreeRounds + 1] = {};///< first node of each round of elimination; the last one: how many there are
  int treeRounds = 0;
  int treeSources = 0;
  int trees = 0;
  bool smallTrees = false;            ///< none has more than kSmallTree bodies
  int treeLimits = 0;                 ///< 1: some tree has limits
  int treesStale = 1;                 ///< 1: bodies or joints were edited since the trees were found
  int vertices = 0;                   ///< slots in use, removed ones included
  int grainCells = 0;                 ///< buckets of the grid of granular particles, a power of two; 0: there are none
  Real grainCell = 1;                 ///< [m]
  int attachments = 0;                ///< slots in use
  int edges = 0, features = 0;        ///< of surfaces that collide: edges come first, then triangles
  int featureCells = 0;               ///< buckets of their grid, a power of two
  Real featureCell = 1;               ///< cells of its finest level [m]
  int clusterBegin[kClusterLevels + 1] = {}; ///< first cluster of each level, fine ones first
  int movingParts = 0;                ///< clusters of the finest level that move as one: they come first
  int clusterRefs = 0;
  int lumps = 0, objects = 0;         ///< those with a cluster come first, and are so many
  int lines = 0, lineVertices = 0;    ///< ropes and rods, and their vertices
  int elements[ElementTypes::kSize] = {}, yielding = 0; ///< slots in use of each type; tetrahedra that can yield
  StepConstants step{};
  Counters* counters = nullptr;

  // bodies: authored
  int* idOf = nullptr;                ///< BodyId::index of the body at each place in these tables
  int* placeOf = nullptr;             ///< and the place of the body of each id
  BodyParams* params = nullptr;
  BodyExtras* extras = nullptr;
  BodyFilter* filter = nullptr;
  int* planeBody = nullptr;           ///< indices of the planes
  int* exclusionOffset = nullptr;     ///< [bodies + 1], by id, into exclusionBody
  int* exclusionBody = nullptr;       ///< ids that this one does not collide with (higher ones), sorted
  // shapes and materials that bodies share: authored
  Vec4* shapeVector = nullptr;        ///< see ShapeTables
  int* shapeIndex = nullptr;
  ShapePart* shapePart = nullptr;
  SurfaceData* surface = nullptr;     ///< materials that are more than two frictions and a restitution
  // bodies: state
  Vec3d* position = nullptr;          ///< centre of mass [m]
  Quat* orientation = nullptr;        ///< body -> world
  Vec3* velocity = nullptr;           ///< [m/s]
  Vec3* spin = nullptr;               ///< world axes [rad/s]
  Vec3* previousVelocity = nullptr;   ///< one step earlier [m/s]
  Vec3* force = nullptr;              ///< applied by the user, for one step [N]
  Vec3* torque = nullptr;             ///< [N m]
  int* pushed = nullptr;              ///< 1: a force acted in the last step
  Vec3* correction = nullptr;         ///< how far the correction of penetrations below moves a body in a step [m]
  int* asleep = nullptr;              ///< 1 + a body that stands for the island that sleeps, 0: awake
  Real* stillTime = nullptr;          ///< for how long a body has been still [s]
  // bodies: work
  Bounds* bounds = nullptr;           ///< by Bounds stage
  int* bucketCount = nullptr;         ///< bodies of each bucket
  int* bucketOffset = nullptr;        ///< [cells + 1]
  GridEntry* grid = nullptr;          ///< bodies by bucket
  int* pairSlot = nullptr;            ///< [bodies][kPairSlots] partners found
  int* pairCount = nullptr;           ///< pairs that a body owns
  int* agitation = nullptr;           ///< speed that a neighbour may give a body in this step, as the bits of a float [m/s]
  BodyTarget* target = nullptr;       ///< inertial target
  Displacement* moved = nullptr;      ///< x - x^t, present iterate
  Quat* turned = nullptr;             ///< its rotation, q (q^t)^-1
  int* island = nullptr;              ///< a body that stands for the island
  int* islandFlag = nullptr;          ///< of that body: 1 if the island wakes, or does not sleep
  int* rowIsland = nullptr;           ///< lowest body that rows of this step connect with it
  int* islandBonds = nullptr;         ///< bits of what rows do with it, or with the island that it leads (stages/islands/island_momentum.h)
  int* islandMassLength = nullptr;    ///< of the heaviest body of its island in the last step, as the bits of a float, 0: not known [kg m]
  int* islandSlot = nullptr;          ///< place of the island that it leads in these two, -1: none
  IslandSums* islandSums = nullptr;
  IslandRepair* islandRepair = nullptr;
  int* fast = nullptr;                ///< 1: went further than it is thick, or is pressed into what does not yield
  int* nearSurface = nullptr;         ///< 1: its corners may touch the surface of a deformable object
  int* stopBits = nullptr;            ///< part of the way that a body does not make since it meets another, as the bits of a float
  int* stopSeen = nullptr;            ///< stopBits as far as the present round knows them; of bodies that joints hold together: with their leader
  int* stopRound = nullptr;           ///< round in which that changed, or kHasMet
  int* stopPair = nullptr;            ///< 1 + the pair that it stops at, or 0
  Displacement* stopped = nullptr;    ///< the way that it makes then
  int* bounceBody = nullptr;          ///< part of a body in impacts: BounceBody
  BodyMotion* bounceMotion = nullptr;     ///< its velocities before they were taken back
  Vec3* nextCorrection = nullptr;     ///< correction as this step finds it [m]
  int* color = nullptr;               ///< kept from step to step
  int* nextColor = nullptr;           ///< of the bodies that choose one
  int* clashing = nullptr;            ///< bodies, and vertices (kVertexNode + index), that choose a colour in this step
  int* colorBody = nullptr;           ///< dynamic bodies by colour
  int* entryCount = nullptr;          ///< row blocks of a body
  int* entryOffset = nullptr;         ///< [bodies + 1]
  // groups, whose members are bodies and, numbered from `bodies` on, lumps; arrays over (level, member) have index level * members() + member
  int* leader = nullptr;              ///< [level][member] forest of groups being united
  int* memberCount = nullptr;         ///< [level][member] members of the group that the member leads
  int* leads = nullptr;               ///< [level][member] 1: leads a group of two or more
  int* groupIndex = nullptr;          ///< [level][member] its number, coarse levels last
  int* groupOf = nullptr;             ///< [level][member] its group, -1: alone
  int* member = nullptr;              ///< by group, ascending
  Group* group = nullptr;
  int* memberOffset = nullptr;        ///< [groups + 1] into member
  int* groupChunks = nullptr;         ///< chunks of each group
  int* chunkOffset = nullptr;         ///< [groups + 1]
  Chunk* chunk = nullptr;
  int* externalCount = nullptr;       ///< row blocks between a chunk's bodies and others
  int* externalOffset = nullptr;      ///< [chunks + 1]
  std::uint32_t* external = nullptr;  ///< entry codes by chunk
  int* levelGroup = nullptr;          ///< [levels + 1] first group of a level
  int* levelChunk = nullptr;          ///< [levels + 1] first chunk of a level
  // trees of joints: derived, and work
  int* nodeOfBody = nullptr;          ///< of each body, -1: none
  TreeNode* treeNode = nullptr;       ///< by round
  int* treeOffset = nullptr;          ///< [trees + 1]
  int* treeMember = nullptr;          ///< nodes by tree, then by round
  int* treeSource = nullptr;          ///< 2 * node + side of its coupling, by the node that it passes something on to
  TreeWork* treeWork = nullptr;
  int* treeTouched = nullptr;         ///< what touches the tree in this step (state/trees.h)
  int* treeRests = nullptr;           ///< by tree: it stays as it is in this solve
  int* treeTurn = nullptr;            ///< largest rotation of a tree's step, as the bits of a float [rad]
  int* treeOpen = nullptr;            ///< 1: a joint of the tree is open at the end of the step
  TreeLink* treeLink = nullptr;
  // colours
  int* colorCount = nullptr;          ///< bodies of each colour
  int* colorOffset = nullptr;         ///< [colors + 1]
  // pairs
  int* pairOffset = nullptr;          ///< [bodies + 1] first pair of a body
  int* oldPairOffset = nullptr;
  Pair* pair = nullptr;               ///< by owner, then by partner
  Pair* oldPair = nullptr;
  PairTest* pairTest = nullptr;       ///< the last full test of each pair
  PairTest* oldPairTest = nullptr;
  int* manifoldBefore = nullptr;      ///< that a pair had in the step before, -1: none
  int* freshPair = nullptr;           ///< pairs of which nothing is known yet
  int* isNear = nullptr;              ///< 1 if points of the pair may take part in the step
  int* nearPairOffset = nullptr;      ///< [pairs + 1] near pairs before this one
  int* oldNearPairOffset = nullptr;
  int* nearPair = nullptr;            ///< the pairs that are near
  Manifold* manifold = nullptr;       ///< one a near pair
  Manifold* oldManifold = nullptr;
  int* meetBits = nullptr;            ///< part of the way that is left when its bodies meet, as the bits of a float; 0: never
  int* tested = nullptr;              ///< manifolds whose narrow phase is run anew
  int* hasRows = nullptr;             ///< 1 if a point of the manifold takes part in the step
  RollingRows* rolling = nullptr;     ///< one a manifold, if rolls
  RollingRows* oldRolling = nullptr;
  int* rowOffset = nullptr;           ///< [near pairs + 1] manifolds with rows before this one
  // rows
  ContactRows* contact = nullptr;     ///< one a manifold that has rows, in the order of manifolds; where the old manifolds were (Tables::lodgeRows)
  Bounce* bounce = nullptr;           ///< one for each of them, if something may bounce in the step
  Support* support = nullptr;         ///< one a manifold that has rows
  int* joinLevel = nullptr;           ///< level of the groups at which they unite their bodies, kCoarseLevels: at none
  Entry* entry = nullptr;             ///< row blocks by body

  // vertices: authored
  VertexParams* vertexParams = nullptr;
  int* refOffset = nullptr;           ///< [vertices + 1] into ref
  std::uint32_t* ref = nullptr;       ///< elements of each vertex but tetrahedra, then attachments
  int* tetraCornerOffset = nullptr;   ///< [vertices + 1] into tetraCorner
  TetraCorner* tetraCorner = nullptr; ///< tetrahedra of each vertex
  Sym3* cornerStart = nullptr;        ///< their E^t in this step, 0 without viscosity
  int* neighborOffset = nullptr;      ///< [vertices + 1] into neighbor
  int* neighbor = nullptr;            ///< vertices that share an element or attachment with this one, sorted
  // vertices: state
  Vec3d* vertexPosition = nullptr;    ///< [m]
  Vec3* vertexVelocity = nullptr;     ///< [m/s]
  Vec3* vertexOldVelocity = nullptr;  ///< one step earlier [m/s]
  Vec3* vertexForce = nullptr;        ///< applied by the user, for one step [N]
  int* vertexColor = nullptr;
  // vertices: work
  Vec3* vertexTarget = nullptr;       ///< y - x^t [m]
  Vec3* vertexMoved = nullptr;        ///< x - x^t, present iterate [m]
  PastVertex* pastVertex = nullptr;
  PaddedVec3* vertexPlace = nullptr;  ///< x from the first vertex of its object at x^t, present iterate [m]
  int* vertexNextColor = nullptr;
  int* colorVertex = nullptr;         ///< dynamic vertices by colour
  int* grainCount = nullptr;          ///< granular particles of each bucket
  int* grainOffset = nullptr;         ///< [grainCells + 1]
  BoxEntry* grain = nullptr;          ///< granular particles by bucket
  // vertices and edges as owners of pairs
  int* pointPairSlot = nullptr;       ///< [owners][kPointPairSlots] partners found
  int* pointPairCount = nullptr;      ///< pairs that a vertex or edge owns
  int* pointPairOffset = nullptr;     ///< [owners + 1] first pair of an owner
  int* oldPointPairOffset = nullptr;
  // surfaces
  SurfaceFeature* feature = nullptr;         ///< authored
  Vec3* vertexRest = nullptr;         ///< authored: shape at rest, from the first vertex of the object [m]
  int* featureCount = nullptr;        ///< features of each bucket
  int* featureOffset = nullptr;       ///< [featureCells + 1]
  BoxEntry* featureEntry = nullptr;  ///< features by bucket
  VertexRepair* vertexRepair = nullptr;
  NearFeature* nearFeature = nullptr;  ///< by owner, in no fixed order
  int* nearCount = nullptr;           ///< of each vertex and edge
  int* nearOffset = nullptr;          ///< [owners + 1]
  int* pointEntryCount = nullptr;     ///< contacts of a vertex
  int* pointEntryOffset = nullptr;    ///< [vertices + 1]
  int* vertexColorCount = nullptr;    ///< vertices of each colour
  int* vertexColorOffset = nullptr;   ///< [colors + 1]
  // pairs of vertices with bodies and with one another, and their rows
  PointPair* pointPair = nullptr;     ///< by vertex, then by partner
  PointPair* oldPointPair = nullptr;
  PointContact* pointContact = nullptr;  ///< one a pair
  PointContact* oldPointContact = nullptr;
  std::uint32_t* pointEntry = nullptr;   ///< contacts by vertex
  // clusters
  Cluster* cluster = nullptr;            ///< by level
  int* clusterMember = nullptr;          ///< dynamic vertices of objects with elements, by cluster
  ClusterRef* clusterRef = nullptr;      ///< elements that leave a cluster, by cluster
  ClusterMotion* clusterMotion = nullptr;
  Lump* lump = nullptr;                  ///< objects, then granular particles
  Block3* lumpSum = nullptr;             ///< force and Hessian of a lump as its group sees it
  Line* line = nullptr;
  LineVertex* lineVertex = nullptr;      ///< by line, from one end to the other
  LineWork* lineWork = nullptr;
  Real* lineShare = nullptr;             ///< of the step of a line that it makes [1]
  // elements
  Attachment* attachment = nullptr;
  Tetrahedron* tetrahedron = nullptr;
  Membrane* membrane = nullptr;
  FlatBend* flatBend = nullptr;
  FoldBend* foldBend = nullptr;
  LineBend* lineBend = nullptr;
  Spring* spring = nullptr;
  Pressure* pressure = nullptr;

  template <class F>
  RUBBLE_HD F* elementsOf() const {
    if constexpr (std::is_same_v<F, Tetrahedron>) return tetrahedron;
    else if constexpr (std::is_same_v<F, Membrane>) return membrane;
    else if constexpr (std::is_same_v<F, FlatBend>) return flatBend;
    else if constexpr (std::is_same_v<F, FoldBend>) return foldBend;
    else if constexpr (std::is_same_v<F, LineBend>) return lineBend;
    else if constexpr (std::is_same_v<F, Spring>) return spring;
    else return pressure;
  }
  /// What may be in a group.
  RUBBLE_HD int members() const { return bodies + lumps; }
  RUBBLE_HD int jointSlots() const {
    int all = 0;
    for (const int n : joints) all += n;
    return all;
  }
  RUBBLE_HD bool hasJoints() const { return jointSlots() > 0; }
  /// What owns pairs of vertices: every vertex, every edge, then corners of every body, if there is a surface.
  RUBBLE_HD int owners() const { return vertices + edges + (features > 0 ? kCornerSlots * bodies : 0); }
  RUBBLE_HD ShapeTables shapeTables() const { return {shapeVector, shapeIndex, shapePart}; }

  template <class F>
  RUBBLE_HD JointSpec<F>* specsOf() const { return JointTable<F>::spec; }
  template <class F>
  RUBBLE_HD Joint<F>* jointsOf() const { return JointTable<F>::joint; }
  template <class F>
  RUBBLE_HD TreeRows<F>* treeRowsOf() const { return JointTable<F>::treeRows; }
  template <class F>
  RUBBLE_HD JointTurns<F>* turnsOf() const { return JointTable<F>::turns; }
};

/// Slots in use of a type of element, 0 for other kinds.
inline std::size_t elementCount(const View& s, Per per) {
  const int type = static_cast<int>(per) - static_cast<int>(Per::FirstElement);
  return type >= 0 && type < ElementTypes::kSize ? static_cast<std::size_t>(s.elements[type]) : 0;
}

template <class T>
struct ArrayInfo {
  T* View::*member;
  const char* name;
  const char* unit;
  Per per;
  Life life;
  int extra = 0;  ///< elements beyond one for each
  bool lodges = false;  ///< in the memory of another array
};

/// Calls f(ArrayInfo) for every array.
template <class F>
void forEachArray(F&& f) {
  const auto is = [&]<class T>(T* View::*member, const char* name, const char* unit, Per per, Life life, int extra = 0) {
    f(ArrayInfo<T>{member, name, unit, per, life, extra});
  };
  is(&View::idOf, "idOf", "", Per::Body, Life::Authored);
  is(&View::placeOf, "placeOf", "", Per::Body, Life::Authored);
  is(&View::params, "params", "", Per::Body, Life::Authored);
  is(&View::extras, "extras", "1/s", Per::Body, Life::Authored);
  is(&View::filter, "filter", "", Per::Body, Life::Authored);
  is(&View::planeBody, "planeBody", "", Per::Plane, Life::Authored);
  is(&View::exclusionOffset, "exclusionOffset", "", Per::Body, Life::Authored, 1);
  is(&View::exclusionBody, "exclusionBody", "", Per::Exclusion, Life::Authored);
  is(&View::shapeVector, "shapeVector", "m", Per::ShapeVector, Life::Authored);
  is(&View::shapeIndex, "shapeIndex", "", Per::ShapeIndex, Life::Authored);
  is(&View::shapePart, "shapePart", "", Per::ShapePart, Life::Authored);
  is(&View::surface, "surface", "", Per::Surface, Life::Authored);
  is(&View::position, "position", "m", Per::Body, Life::State);
  is(&View::orientation, "orientation", "", Per::Body, Life::State);
  is(&View::velocity, "velocity", "m/s", Per::Body, Life::State);
  is(&View::spin, "spin", "rad/s", Per::Body, Life::State);
  is(&View::previousVelocity, "previousVelocity", "m/s", Per::Body, Life::State);
  is(&View::force, "force", "N", Per::Body, Life::State);
  is(&View::torque, "torque", "N m", Per::Body, Life::State);
  is(&View::pushed, "pushed", "", Per::Body, Life::State);
  is(&View::correction, "correction", "m", Per::Body, Life::State);
  is(&View::color, "color", "", Per::Body, Life::State);
  is(&View::islandMassLength, "islandMassLength", "kg m", Per::Body, Life::State);
  is(&View::asleep, "asleep", "", Per::Body, Life::State);
  is(&View::stillTime, "stillTime", "s", Per::Body, Life::State);
  is(&View::oldPairOffset, "oldPairOffset", "", Per::Body, Life::State, 1);
  is(&View::oldPair, "oldPair", "", Per::Pair, Life::State);
  is(&View::oldPairTest, "oldPairTest", "m", Per::Pair, Life::State);
  is(&View::oldNearPairOffset, "oldNearPairOffset", "", Per::Pair, Life::State, 1);
  is(&View::oldManifold, "oldManifold", "", Per::NearPair, Life::State);
  is(&View::oldRolling, "oldRolling", "", Per::Rolling, Life::State);
  is(&View::rolling, "rolling", "", Per::Rolling, Life::Work);
  forEachType(JointTypes{}, [&]<class J>() {
    const Per per = perJoint(typeIndex<J>(JointTypes{}));
    is(static_cast<JointSpec<J>* View::*>(&JointTable<J>::spec), J::kName, "", per, Life::Authored);
    is(static_cast<Joint<J>* View::*>(&JointTable<J>::joint), J::kName, "", per, Life::State);
    is(static_cast<TreeRows<J>* View::*>(&JointTable<J>::treeRows), J::kName, "", per, Life::Work);
    if constexpr (hasTurns<J>()) is(static_cast<JointTurns<J>* View::*>(&JointTable<J>::turns), J::kName, "", per, Life::Work);
  });
  is(&View::bounds, "bounds", "m", Per::Body, Life::Work);
  is(&View::bucketCount, "bucketCount", "", Per::Cell, Life::Work);
  is(&View::bucketOffset, "bucketOffset", "", Per::Cell, Life::Work, 1);
  is(&View::grid, "grid", "", Per::Body, Life::Unordered);
  is(&View::pairSlot, "pairSlot", "", Per::BodySlot, Life::Unordered);
  is(&View::pairCount, "pairCount", "", Per::Body, Life::Work);
  is(&View::agitation, "agitation", "m/s", Per::Body, Life::Work);
  is(&View::target, "target", "", Per::Body, Life::Work);
  is(&View::moved, "moved", "m, rad", Per::Body, Life::Work);
  is(&View::turned, "turned", "", Per::Body, Life::Work);
  is(&View::island, "island", "", Per::Body, Life::Unordered);
  is(&View::islandFlag, "islandFlag", "", Per::Body, Life::Work);
  is(&View::rowIsland, "rowIsland", "", Per::Body, Life::Work);
  is(&View::islandBonds, "islandBonds", "", Per::Body, Life::Work);
  is(&View::islandSlot, "islandSlot", "", Per::Body, Life::Unordered);
  is(&View::islandSums, "islandSums", "", Per::FreeIsland, Life::Unordered);
  is(&View::islandRepair, "islandRepair", "m, s", Per::FreeIsland, Life::Unordered);
  is(&View::fast, "fast", "", Per::Body, Life::Work);
  is(&View::nearSurface, "nearSurface", "", Per::Body, Life::Work);
  is(&View::bounceBody, "bounceBody", "", Per::Body, Life::Work);
  is(&View::bounceMotion, "bounceMotion", "m/s, rad/s", Per::Body, Life::Work);
  is(&View::bounce, "bounce", "N, N s", Per::Bounce, Life::Work);
  is(&View::stopBits, "stopBits", "", Per::Body, Life::Work);
  is(&View::stopSeen, "stopSeen", "", Per::Body, Life::Work);
  is(&View::stopRound, "stopRound", "", Per::Body, Life::Work);
  is(&View::stopPair, "stopPair", "", Per::Body, Life::Work);
  is(&View::stopped, "stopped", "m, rad", Per::Body, Life::Work);
  is(&View::nextCorrection, "nextCorrection", "m, rad", Per::Body, Life::Work);
  is(&View::nextColor, "nextColor", "", Per::Body, Life::Unordered);
  is(&View::clashing, "clashing", "", Per::Node, Life::Unordered);
  is(&View::colorBody, "colorBody", "", Per::Body, Life::Unordered);
  is(&View::entryCount, "entryCount", "", Per::Body, Life::Work);
  is(&View::entryOffset, "entryOffset", "", Per::Body, Life::Work, 1);
  is(&View::leader, "leader", "", Per::MemberLevel, Life::Unordered);
  is(&View::memberCount, "memberCount", "", Per::MemberLevel, Life::Work);
  is(&View::leads, "leads", "", Per::MemberLevel, Life::Work);
  is(&View::groupIndex, "groupIndex", "", Per::MemberLevel, Life::Work, 1);
  is(&View::groupOf, "groupOf", "", Per::MemberLevel, Life::Work);
  is(&View::member, "member", "", Per::MemberLevel, Life::Work);
  is(&View::group, "group", "", Per::Group, Life::Work);
  is(&View::memberOffset, "memberOffset", "", Per::Group, Life::Work, 1);
  is(&View::groupChunks, "groupChunks", "", Per::Group, Life::Work);
  is(&View::chunkOffset, "chunkOffset", "", Per::Group, Life::Work, 1);
  is(&View::chunk, "chunk", "", Per::Chunk, Life::Work);
  is(&View::externalCount, "externalCount", "", Per::Chunk, Life::Work);
  is(&View::externalOffset, "externalOffset", "", Per::Chunk, Life::Work, 1);
  is(&View::external, "external", "", Per::External, Life::Work);
  is(&View::levelGroup, "levelGroup", "", Per::Level, Life::Work, kCoarseLevels);
  is(&View::levelChunk, "levelChunk", "", Per::Level, Life::Work, kCoarseLevels);
  is(&View::nodeOfBody, "nodeOfBody", "", Per::Body, Life::Derived);
  is(&View::treeNode, "treeNode", "", Per::TreeNode, Life::Derived);
  is(&View::treeSource, "treeSource", "", Per::TreeSource, Life::Derived);
  is(&View::treeOffset, "treeOffset", "", Per::TreeNode, Life::Derived, 1);
  is(&View::treeMember, "treeMember", "", Per::TreeNode, Life::Derived);
  is(&View::treeWork, "treeWork", "", Per::TreeNode, Life::Work);
  is(&View::treeTouched, "treeTouched", "", Per::TreeNode, Life::Work);
  is(&View::treeRests, "treeRests", "", Per::TreeNode, Life::Work);
  is(&View::treeTurn, "treeTurn", "", Per::TreeNode, Life::Work);
  is(&View::treeOpen, "treeOpen", "", Per::TreeNode, Life::Work);
  is(&View::treeLink, "treeLink", "", Per::TreeNode, Life::Work);
  is(&View::colorCount, "colorCount", "", Per::Color, Life::Work);
  is(&View::colorOffset, "colorOffset", "", Per::Color, Life::Work, 1);
  is(&View::pairOffset, "pairOffset", "", Per::Body, Life::Work, 1);
  is(&View::pair, "pair", "", Per::Pair, Life::Work);
  is(&View::pairTest, "pairTest", "m", Per::Pair, Life::Work);
  is(&View::manifoldBefore, "manifoldBefore", "", Per::Pair, Life::Work);
  is(&View::freshPair, "freshPair", "", Per::Pair, Life::Unordered);
  is(&View::isNear, "isNear", "", Per::Pair, Life::Work);
  is(&View::nearPairOffset, "nearPairOffset", "", Per::Pair, Life::Work, 1);
  is(&View::meetBits, "meetBits", "", Per::Pair, Life::Work);
  is(&View::nearPair, "nearPair", "", Per::NearPair, Life::Work);
  is(&View::manifold, "manifold", "", Per::NearPair, Life::Work);
  is(&View::tested, "tested", "", Per::NearPair, Life::Unordered);
  is(&View::hasRows, "hasRows", "", Per::NearPair, Life::Work);
  is(&View::rowOffset, "rowOffset", "", Per::NearPair, Life::Work, 1);
  f(ArrayInfo<ContactRows>{&View::contact, "contact", "", Per::Manifold, Life::State, 0, true});
  is(&View::joinLevel, "joinLevel", "", Per::Manifold, Life::Work);
  is(&View::support, "support", "N", Per::Manifold, Life::Work);
  is(&View::entry, "entry", "", Per::Entry, Life::Work);
  is(&View::vertexParams, "vertexParams", "", Per::Vertex, Life::Authored);
  is(&View::refOffset, "refOffset", "", Per::Vertex, Life::Authored, 1);
  is(&View::ref, "ref", "", Per::ElementRef, Life::Authored);
  is(&View::tetraCornerOffset, "tetraCornerOffset", "", Per::Vertex, Life::Authored, 1);
  is(&View::tetraCorner, "tetraCorner", "", Per::TetraCorner, Life::Authored);
  is(&View::cornerStart, "cornerStart", "", Per::TetraCorner, Life::Work);
  is(&View::neighborOffset, "neighborOffset", "", Per::Vertex, Life::Authored, 1);
  is(&View::neighbor, "neighbor", "", Per::Neighbor, Life::Authored);
  is(&View::vertexRest, "vertexRest", "m", Per::Vertex, Life::Authored);
  is(&View::feature, "feature", "", Per::Feature, Life::Authored);
  is(&View::vertexPosition, "vertexPosition", "m", Per::Vertex, Life::State);
  is(&View::vertexVelocity, "vertexVelocity", "m/s", Per::Vertex, Life::State);
  is(&View::vertexOldVelocity, "vertexOldVelocity", "m/s", Per::Vertex, Life::State);
  is(&View::vertexForce, "vertexForce", "N", Per::Vertex, Life::State);
  is(&View::vertexColor, "vertexColor", "", Per::Vertex, Life::State);
  is(&View::oldPointPairOffset, "oldPointPairOffset", "", Per::PointOwner, Life::State, 1);
  is(&View::oldPointPair, "oldPointPair", "", Per::PointPair, Life::State);
  is(&View::oldPointContact, "oldPointContact", "", Per::PointPair, Life::State);
  is(&View::attachment, "attachment", "", Per::Attachment, Life::State);
  is(&View::tetrahedron, "tetrahedron", "", perElement<Tetrahedron>(), Life::State);
  is(&View::membrane, "membrane", "", perElement<Membrane>(), Life::State);
  is(&View::flatBend, "flatBend", "", perElement<FlatBend>(), Life::State);
  is(&View::foldBend, "foldBend", "", perElement<FoldBend>(), Life::State);
  is(&View::lineBend, "lineBend", "", perElement<LineBend>(), Life::State);
  is(&View::spring, "spring", "", perElement<Spring>(), Life::State);
  is(&View::pressure, "pressure", "", perElement<Pressure>(), Life::State);
  is(&View::cluster, "cluster", "", Per::Cluster, Life::Authored);
  is(&View::clusterMember, "clusterMember", "", Per::Vertex, Life::Authored);
  is(&View::clusterRef, "clusterRef", "", Per::ClusterRef, Life::Authored);
  is(&View::clusterMotion, "clusterMotion", "", Per::Cluster, Life::Work);
  is(&View::lump, "lump", "", Per::Lump, Life::Authored);
  is(&View::lumpSum, "lumpSum", "", Per::Lump, Life::Work);
  is(&View::line, "line", "", Per::Line, Life::Authored);
  is(&View::lineVertex, "lineVertex", "", Per::LineVertex, Life::Authored);
  is(&View::lineWork, "lineWork", "", Per::LineVertex, Life::Work);
  is(&View::lineShare, "lineShare", "", Per::Line, Life::Work);
  is(&View::vertexTarget, "vertexTarget", "m", Per::Vertex, Life::Work);
  is(&View::vertexMoved, "vertexMoved", "m", Per::Vertex, Life::Work);
  is(&View::pastVertex, "pastVertex", "m", Per::Vertex, Life::Work);
  is(&View::vertexPlace, "vertexPlace", "m", Per::Vertex, Life::Work);
  is(&View::vertexNextColor, "vertexNextColor", "", Per::Vertex, Life::Work);
  is(&View::colorVertex, "colorVertex", "", Per::Vertex, Life::Unordered);
  is(&View::grainCount, "grainCount", "", Per::GrainCell, Life::Work);
  is(&View::grainOffset, "grainOffset", "", Per::GrainCell, Life::Work, 1);
  is(&View::grain, "grain", "", Per::Vertex, Life::Unordered);
  is(&View::pointPairSlot, "pointPairSlot", "", Per::PointOwnerSlot, Life::Unordered);
  is(&View::pointPairCount, "pointPairCount", "", Per::PointOwner, Life::Work);
  is(&View::pointPairOffset, "pointPairOffset", "", Per::PointOwner, Life::Work, 1);
  is(&View::pointEntryCount, "pointEntryCount", "", Per::Vertex, Life::Work);
  is(&View::pointEntryOffset, "pointEntryOffset", "", Per::Vertex, Life::Work, 1);
  is(&View::featureCount, "featureCount", "", Per::FeatureCell, Life::Work);
  is(&View::featureOffset, "featureOffset", "", Per::FeatureCell, Life::Work, 1);
  is(&View::featureEntry, "featureEntry", "", Per::Feature, Life::Unordered);
  is(&View::vertexRepair, "vertexRepair", "", Per::Vertex, Life::Work);
  is(&View::nearFeature, "nearFeature", "", Per::NearFeature, Life::Unordered);
  is(&View::nearCount, "nearCount", "", Per::PointOwner, Life::Work);
  is(&View::nearOffset, "nearOffset", "", Per::PointOwner, Life::Work, 1);
  is(&View::vertexColorCount, "vertexColorCount", "", Per::Color, Life::Work);
  is(&View::vertexColorOffset, "vertexColorOffset", "", Per::Color, Life::Work, 1);
  is(&View::pointPair, "pointPair", "", Per::PointPair, Life::Work);
  is(&View::pointContact, "pointContact", "", Per::PointPair, Life::Work);
  is(&View::pointEntry, "pointEntry", "", Per::PointEntry, Life::Work);
}

/// Bodies that are solved by trees.
RUBBLE_HD inline int treeNodes(const View& s) { return s.treeBegin[kTreeRounds]; }

/// What is edited does not sleep on; its island wakes with it, for it is a moving neighbour of the others.
RUBBLE_HD inline void rouse(const View& s, int body) {
  s.asleep[body] = 0;
  s.stillTime[body] = 0;
}
RUBBLE_HD inline bool isAsleep(const View& s, int body) { return s.step.sleeping && s.asleep[body] != 0; }
/// Does the step move it by its forces? Bodies that sleep are like static ones.
RUBBLE_HD inline bool isDynamic(const View& s, int body) {
  return body != kWorldBody && s.params[body].kind == BodyKind::Dynamic && !isAsleep(s, body);
}

}  // namespace rubble::RUBBLE_CORE
