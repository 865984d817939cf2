#pragma once
/// The table of all arrays of SolverData: name, unit, number of elements and lifetime.
#include "state/solver_data.h"

namespace rubble::RUBBLE_CORE {

template <class T> struct ArrayInfo {
  Array<T> SolverData::*member;
  const char* name;
  const char* unit;
  Per per;
  Lifetime life;
  int extra = 0;         ///< elements beyond one per `per`
  bool aliases = false;  ///< shares the memory of another array
};

/// Calls f(ArrayInfo) for every array.
template <class F> void forEachArray(F&& f) {
  const auto is = [&]<class T>(Array<T> SolverData::*member, const char* name, const char* unit, Per per,
                               Lifetime life, int extra = 0) {
    f(ArrayInfo<T>{member, name, unit, per, life, extra});
  };
  is(&SolverData::idOf, "idOf", "", Per::Body, Lifetime::Authored);
  is(&SolverData::placeOf, "placeOf", "", Per::Body, Lifetime::Authored);
  is(&SolverData::step, "step", "", Per::World, Lifetime::Batch);
  is(&SolverData::worldOfBody, "worldOfBody", "", Per::Body, Lifetime::Batch);
  is(&SolverData::firstBody, "firstBody", "", Per::World, Lifetime::Batch, 1);
  is(&SolverData::worldOfVertex, "worldOfVertex", "", Per::Vertex, Lifetime::Batch);
  is(&SolverData::firstVertex, "firstVertex", "", Per::World, Lifetime::Batch, 1);
  is(&SolverData::firstPlane, "firstPlane", "", Per::World, Lifetime::Batch, 1);
  is(&SolverData::paused, "paused", "", Per::World, Lifetime::Batch);
  is(&SolverData::params, "params", "", Per::Body, Lifetime::Authored);
  is(&SolverData::extras, "extras", "1/s", Per::Body, Lifetime::Authored);
  is(&SolverData::filter, "filter", "", Per::Body, Lifetime::Authored);
  is(&SolverData::planeBody, "planeBody", "", Per::Plane, Lifetime::Authored);
  is(&SolverData::exclusion, "exclusion", "", Per::Exclusion, Lifetime::Authored);
  is(&SolverData::shapeVector, "shapeVector", "m", Per::ShapeVector, Lifetime::Authored);
  is(&SolverData::shapeIndex, "shapeIndex", "", Per::ShapeIndex, Lifetime::Authored);
  is(&SolverData::shapePart, "shapePart", "", Per::ShapePart, Lifetime::Authored);
  is(&SolverData::surface, "surface", "", Per::Surface, Lifetime::Authored);
  is(&SolverData::materialRule, "materialRule", "", Per::MaterialRule, Lifetime::Batch);
  is(&SolverData::position, "position", "m", Per::Body, Lifetime::State);
  is(&SolverData::orientation, "orientation", "", Per::Body, Lifetime::State);
  is(&SolverData::velocity, "velocity", "m/s", Per::Body, Lifetime::State);
  is(&SolverData::angularVelocity, "angularVelocity", "rad/s", Per::Body, Lifetime::State);
  is(&SolverData::previousVelocity, "previousVelocity", "m/s", Per::Body, Lifetime::State);
  is(&SolverData::force, "force", "N", Per::Body, Lifetime::State);
  is(&SolverData::torque, "torque", "N m", Per::Body, Lifetime::State);
  is(&SolverData::pushed, "pushed", "", Per::Body, Lifetime::State);
  is(&SolverData::correction, "correction", "m", Per::Body, Lifetime::State);
  is(&SolverData::color, "color", "", Per::Body, Lifetime::State);
  is(&SolverData::islandMassLength, "islandMassLength", "kg m", Per::Body, Lifetime::State);
  is(&SolverData::asleep, "asleep", "", Per::Body, Lifetime::State);
  is(&SolverData::stillTime, "stillTime", "s", Per::Body, Lifetime::State);
  is(&SolverData::oldPairOffset, "oldPairOffset", "", Per::Body, Lifetime::State, 1);
  is(&SolverData::oldPair, "oldPair", "", Per::Pair, Lifetime::State);
  is(&SolverData::oldPairTest, "oldPairTest", "m", Per::Pair, Lifetime::State);
  is(&SolverData::oldActivePairOffset, "oldActivePairOffset", "", Per::Pair, Lifetime::State, 1);
  is(&SolverData::oldManifold, "oldManifold", "", Per::ActivePair, Lifetime::State);
  is(&SolverData::oldRolling, "oldRolling", "", Per::Rolling, Lifetime::State);
  is(&SolverData::rolling, "rolling", "", Per::Rolling, Lifetime::Work);
  forEachType(JointTypes{}, [&]<class J>() {
    const Per per = perJoint(typeIndex<J>(JointTypes{}));
    is(static_cast<Array<JointSpec<J>> SolverData::*>(&JointTable<J>::spec), J::kName, "", per,
       Lifetime::Authored);
    is(static_cast<Array<Joint<J>> SolverData::*>(&JointTable<J>::joint), J::kName, "", per, Lifetime::State);
    is(static_cast<Array<TreeRows<J>> SolverData::*>(&JointTable<J>::treeRows), J::kName, "", per,
       Lifetime::Work);
    if constexpr (hasAngularRows<J>())
      is(static_cast<Array<JointAngularRows<J>> SolverData::*>(&JointTable<J>::angularRows), J::kName, "",
         per, Lifetime::Work);
  });
  is(&SolverData::bounds, "bounds", "m", Per::Body, Lifetime::Work);
  is(&SolverData::bucketCount, "bucketCount", "", Per::Cell, Lifetime::Work);
  is(&SolverData::bucketOffset, "bucketOffset", "", Per::Cell, Lifetime::Work, 1);
  is(&SolverData::grid, "grid", "", Per::Body, Lifetime::Unordered);
  is(&SolverData::cellPaths, "cellPaths", "m", Per::PathCell, Lifetime::Work);
  is(&SolverData::subcellFirst, "subcellFirst", "", Per::PathCell, Lifetime::Unordered);
  is(&SolverData::subcellNext, "subcellNext", "", Per::PathCell, Lifetime::Unordered);
  is(&SolverData::pairSlot, "pairSlot", "", Per::BodySlot, Lifetime::Unordered);
  is(&SolverData::neighborSearch, "neighborSearch", "m", Per::Body, Lifetime::Unordered);
  is(&SolverData::searcher, "searcher", "", Per::Body, Lifetime::Unordered);
  is(&SolverData::crowdedBody, "crowdedBody", "", Per::Body, Lifetime::Unordered);
  is(&SolverData::pairCount, "pairCount", "", Per::Body, Lifetime::Work);
  is(&SolverData::impactSpeedBound, "impactSpeedBound", "m/s", Per::Body, Lifetime::Work);
  is(&SolverData::target, "target", "", Per::Body, Lifetime::Work);
  is(&SolverData::dx, "dx", "m, rad", Per::Body, Lifetime::Work);
  is(&SolverData::dq, "dq", "", Per::Body, Lifetime::Work);
  is(&SolverData::island, "island", "", Per::Body, Lifetime::Unordered);
  is(&SolverData::islandFlag, "islandFlag", "", Per::Body, Lifetime::Work);
  is(&SolverData::rowIsland, "rowIsland", "", Per::Body, Lifetime::Work);
  is(&SolverData::islandBonds, "islandBonds", "", Per::Body, Lifetime::Work);
  is(&SolverData::islandSlot, "islandSlot", "", Per::Body, Lifetime::Unordered);
  is(&SolverData::islandSums, "islandSums", "", Per::FreeIsland, Lifetime::Unordered);
  is(&SolverData::islandRepair, "islandRepair", "m, s", Per::FreeIsland, Lifetime::Unordered);
  is(&SolverData::fast, "fast", "", Per::Body, Lifetime::Work);
  is(&SolverData::fastBody, "fastBody", "", Per::Body, Lifetime::Unordered);
  is(&SolverData::searchedBody, "searchedBody", "", Per::Body, Lifetime::Unordered);
  is(&SolverData::nearSurface, "nearSurface", "", Per::Body, Lifetime::Work);
  is(&SolverData::bounceBody, "bounceBody", "", Per::Body, Lifetime::Work);
  is(&SolverData::bounceMotion, "bounceMotion", "m/s, rad/s", Per::Body, Lifetime::Work);
  is(&SolverData::bounce, "bounce", "N, N s", Per::Bounce, Lifetime::Work);
  is(&SolverData::ccdShareBits, "ccdShareBits", "", Per::Body, Lifetime::Work);
  is(&SolverData::ccdSeenBits, "ccdSeenBits", "", Per::Body, Lifetime::Work);
  is(&SolverData::ccdRound, "ccdRound", "", Per::Body, Lifetime::Work);
  is(&SolverData::ccdPair, "ccdPair", "", Per::Body, Lifetime::Work);
  is(&SolverData::ccdCarrier, "ccdCarrier", "", Per::Body, Lifetime::Work);
  is(&SolverData::ccdRunInto, "ccdRunInto", "", Per::Body, Lifetime::Work);
  is(&SolverData::ccdMotion, "ccdMotion", "m, rad", Per::Body, Lifetime::Work);
  is(&SolverData::nextCorrection, "nextCorrection", "m, rad", Per::Body, Lifetime::Work);
  is(&SolverData::nextColor, "nextColor", "", Per::Body, Lifetime::Unordered);
  is(&SolverData::clashing, "clashing", "", Per::Node, Lifetime::Unordered);
  is(&SolverData::colorBody, "colorBody", "", Per::Body, Lifetime::Unordered);
  is(&SolverData::incidenceCount, "incidenceCount", "", Per::Body, Lifetime::Work);
  is(&SolverData::incidenceOffset, "incidenceOffset", "", Per::Body, Lifetime::Work, 1);
  is(&SolverData::root, "root", "", Per::NodeLevel, Lifetime::Unordered);
  is(&SolverData::nodeCount, "nodeCount", "", Per::NodeLevel, Lifetime::Work);
  is(&SolverData::isRoot, "isRoot", "", Per::NodeLevel, Lifetime::Work);
  is(&SolverData::aggregateIndex, "aggregateIndex", "", Per::NodeLevel, Lifetime::Work, 1);
  is(&SolverData::aggregateOf, "aggregateOf", "", Per::NodeLevel, Lifetime::Work);
  is(&SolverData::aggregateNode, "aggregateNode", "", Per::Member, Lifetime::Work);
  is(&SolverData::aggregate, "aggregate", "", Per::Aggregate, Lifetime::Work);
  is(&SolverData::aggregateOffset, "aggregateOffset", "", Per::Aggregate, Lifetime::Work, 1);
  is(&SolverData::aggregateSlices, "aggregateSlices", "", Per::Aggregate, Lifetime::Work);
  is(&SolverData::sliceOffset, "sliceOffset", "", Per::Aggregate, Lifetime::Work, 1);
  is(&SolverData::slice, "slice", "", Per::Slice, Lifetime::Work);
  is(&SolverData::boundaryCount, "boundaryCount", "", Per::Slice, Lifetime::Work);
  is(&SolverData::boundaryOffset, "boundaryOffset", "", Per::Slice, Lifetime::Work, 1);
  is(&SolverData::boundary, "boundary", "", Per::Boundary, Lifetime::Work);
  is(&SolverData::levelAggregate, "levelAggregate", "", Per::Level, Lifetime::Work, kCoarseLevels);
  is(&SolverData::levelSlice, "levelSlice", "", Per::Level, Lifetime::Work, kCoarseLevels);
  is(&SolverData::columnLinks, "columnLinks", "", Per::Body, Lifetime::Work);
  is(&SolverData::columnCount, "columnCount", "", Per::Body, Lifetime::Work);
  is(&SolverData::columnOffset, "columnOffset", "", Per::Body, Lifetime::Work, 1);
  is(&SolverData::columnLength, "columnLength", "", Per::Body, Lifetime::Work);
  is(&SolverData::columnNode, "columnNode", "", Per::ColumnNode, Lifetime::Work);
  is(&SolverData::columnWork, "columnWork", "", Per::ColumnNode, Lifetime::Work);
  is(&SolverData::nodeOfBody, "nodeOfBody", "", Per::Body, Lifetime::Derived);
  is(&SolverData::treeNode, "treeNode", "", Per::TreeNode, Lifetime::Derived);
  is(&SolverData::treeChild, "treeChild", "", Per::TreeChild, Lifetime::Derived);
  is(&SolverData::nodeLevel, "nodeLevel", "", Per::TreeNode, Lifetime::Derived);
  is(&SolverData::smallTree, "smallTree", "", Per::SmallTree, Lifetime::Derived);
  is(&SolverData::levelNode, "levelNode", "", Per::TreeNode, Lifetime::Derived);
  is(&SolverData::treeWork, "treeWork", "", Per::TreeNode, Lifetime::Work);
  is(&SolverData::treeContacts, "treeContacts", "", Per::TreeNode, Lifetime::Work);
  is(&SolverData::treeConverged, "treeConverged", "", Per::TreeNode, Lifetime::Work);
  is(&SolverData::treeMaxRotation, "treeMaxRotation", "", Per::TreeNode, Lifetime::Work);
  is(&SolverData::treeNeedsProjection, "treeNeedsProjection", "", Per::TreeNode, Lifetime::Work);
  is(&SolverData::projectionLink, "projectionLink", "", Per::TreeNode, Lifetime::Work);
  is(&SolverData::colorCount, "colorCount", "", Per::Color, Lifetime::Unordered);
  is(&SolverData::colorOffset, "colorOffset", "", Per::Color, Lifetime::Work, 1);
  is(&SolverData::pairOffset, "pairOffset", "", Per::Body, Lifetime::Work, 1);
  is(&SolverData::pair, "pair", "", Per::Pair, Lifetime::Work);
  is(&SolverData::pairTest, "pairTest", "m", Per::Pair, Lifetime::Work);
  is(&SolverData::manifoldBefore, "manifoldBefore", "", Per::Pair, Lifetime::Work);
  is(&SolverData::newPair, "newPair", "", Per::Pair, Lifetime::Unordered);
  is(&SolverData::isActive, "isActive", "", Per::Pair, Lifetime::Work);
  is(&SolverData::activePairOffset, "activePairOffset", "", Per::Pair, Lifetime::Work, 1);
  is(&SolverData::sweptPair, "sweptPair", "", Per::Pair, Lifetime::Unordered);
  is(&SolverData::activePair, "activePair", "", Per::ActivePair, Lifetime::Work);
  is(&SolverData::manifold, "manifold", "", Per::ActivePair, Lifetime::Work);
  is(&SolverData::tested, "tested", "", Per::ActivePair, Lifetime::Unordered);
  is(&SolverData::hasRows, "hasRows", "", Per::ActivePair, Lifetime::Work);
  is(&SolverData::rowOffset, "rowOffset", "", Per::ActivePair, Lifetime::Work, 1);
  f(ArrayInfo<ContactRows>{&SolverData::contact, "contact", "", Per::Manifold, Lifetime::State, 0, true});
  is(&SolverData::joinLevel, "joinLevel", "", Per::Manifold, Lifetime::Work);
  is(&SolverData::rowBodies, "rowBodies", "", Per::Manifold, Lifetime::Work);
  is(&SolverData::support, "support", "N", Per::Manifold, Lifetime::Work);
  is(&SolverData::incidence, "incidence", "", Per::Incidence, Lifetime::Work);
  is(&SolverData::vertexParams, "vertexParams", "", Per::Vertex, Lifetime::Authored);
  is(&SolverData::refOffset, "refOffset", "", Per::Vertex, Lifetime::Authored, 1);
  is(&SolverData::ref, "ref", "", Per::ElementRef, Lifetime::Authored);
  is(&SolverData::tetraCornerOffset, "tetraCornerOffset", "", Per::Vertex, Lifetime::Authored, 1);
  is(&SolverData::tetraCorner, "tetraCorner", "", Per::TetraCorner, Lifetime::State);  // its shape flows
  is(&SolverData::cornerStart, "cornerStart", "", Per::TetraCorner, Lifetime::Work);
  is(&SolverData::neighborOffset, "neighborOffset", "", Per::Vertex, Lifetime::Authored, 1);
  is(&SolverData::neighbor, "neighbor", "", Per::Neighbor, Lifetime::Authored);
  is(&SolverData::vertexRest, "vertexRest", "m", Per::Vertex, Lifetime::Authored);
  is(&SolverData::feature, "feature", "", Per::Feature, Lifetime::Authored);
  is(&SolverData::vertexPosition, "vertexPosition", "m", Per::Vertex, Lifetime::State);
  is(&SolverData::vertexVelocity, "vertexVelocity", "m/s", Per::Vertex, Lifetime::State);
  is(&SolverData::vertexOldVelocity, "vertexOldVelocity", "m/s", Per::Vertex, Lifetime::State);
  is(&SolverData::vertexForce, "vertexForce", "N", Per::Vertex, Lifetime::State);
  is(&SolverData::vertexColor, "vertexColor", "", Per::Vertex, Lifetime::State);
  is(&SolverData::oldPointPairOffset, "oldPointPairOffset", "", Per::PointOwner, Lifetime::State, 1);
  is(&SolverData::oldPointPair, "oldPointPair", "", Per::PointPair, Lifetime::State);
  is(&SolverData::oldPointContact, "oldPointContact", "", Per::PointPair, Lifetime::State);
  is(&SolverData::attachment, "attachment", "", Per::Attachment, Lifetime::State);
  forEachType(ElementTypes{}, [&]<class E>() {
    is(static_cast<Array<E> SolverData::*>(&ElementTable<E>::element), E::kName, "", perElement<E>(),
       Lifetime::State);
  });
  is(&SolverData::cluster, "cluster", "", Per::Cluster, Lifetime::Authored);
  is(&SolverData::clusterMember, "clusterMember", "", Per::Vertex, Lifetime::Authored);
  is(&SolverData::clusterRef, "clusterRef", "", Per::ClusterRef, Lifetime::Authored);
  is(&SolverData::clusterMotion, "clusterMotion", "", Per::Cluster, Lifetime::Work);
  is(&SolverData::softNode, "softNode", "", Per::SoftNode, Lifetime::Authored);
  is(&SolverData::softNodeSum, "softNodeSum", "", Per::SoftNode, Lifetime::Work);
  is(&SolverData::strand, "strand", "", Per::Strand, Lifetime::Authored);
  is(&SolverData::strandVertex, "strandVertex", "", Per::StrandVertex, Lifetime::Authored);
  is(&SolverData::strandWork, "strandWork", "", Per::StrandVertex, Lifetime::Work);
  is(&SolverData::strandShare, "strandShare", "", Per::Strand, Lifetime::Work);
  is(&SolverData::vertexTarget, "vertexTarget", "m", Per::Vertex, Lifetime::Work);
  is(&SolverData::vertexMoved, "vertexMoved", "m", Per::Vertex, Lifetime::Work);
  is(&SolverData::vertexIterates, "vertexIterates", "m", Per::Vertex, Lifetime::Work);
  is(&SolverData::vertexPlace, "vertexPlace", "m", Per::Vertex, Lifetime::Work);
  is(&SolverData::vertexNextColor, "vertexNextColor", "", Per::Vertex, Lifetime::Work);
  is(&SolverData::colorVertex, "colorVertex", "", Per::Vertex, Lifetime::Unordered);
  is(&SolverData::particleCount, "particleCount", "", Per::ParticleCell, Lifetime::Work);
  is(&SolverData::particleOffset, "particleOffset", "", Per::ParticleCell, Lifetime::Work, 1);
  is(&SolverData::particle, "particle", "", Per::Vertex, Lifetime::Unordered);
  is(&SolverData::pointPairSlot, "pointPairSlot", "", Per::PointOwnerSlot, Lifetime::Unordered);
  is(&SolverData::pointPairCount, "pointPairCount", "", Per::PointOwner, Lifetime::Work);
  is(&SolverData::pointPairOffset, "pointPairOffset", "", Per::PointOwner, Lifetime::Work, 1);
  is(&SolverData::pointIncidenceCount, "pointIncidenceCount", "", Per::Vertex, Lifetime::Work);
  is(&SolverData::pointIncidenceOffset, "pointIncidenceOffset", "", Per::Vertex, Lifetime::Work, 1);
  is(&SolverData::featureCount, "featureCount", "", Per::FeatureCell, Lifetime::Work);
  is(&SolverData::featureOffset, "featureOffset", "", Per::FeatureCell, Lifetime::Work, 1);
  is(&SolverData::featureEntry, "featureEntry", "", Per::Feature, Lifetime::Unordered);
  is(&SolverData::vertexRepair, "vertexRepair", "", Per::Vertex, Lifetime::Work);
  is(&SolverData::crossingRound, "crossingRound", "", Per::World, Lifetime::Work);
  is(&SolverData::nearFeature, "nearFeature", "", Per::NearFeature, Lifetime::Unordered);
  is(&SolverData::nearCount, "nearCount", "", Per::PointOwner, Lifetime::Work);
  is(&SolverData::nearOffset, "nearOffset", "", Per::PointOwner, Lifetime::Work, 1);
  is(&SolverData::vertexColorCount, "vertexColorCount", "", Per::Color, Lifetime::Unordered);
  is(&SolverData::vertexColorOffset, "vertexColorOffset", "", Per::Color, Lifetime::Work, 1);
  is(&SolverData::pointPair, "pointPair", "", Per::PointPair, Lifetime::Work);
  is(&SolverData::pointContact, "pointContact", "", Per::PointPair, Lifetime::Work);
  is(&SolverData::pointIncidence, "pointIncidence", "", Per::PointIncidence, Lifetime::Work);
}

/// Is element k of the array a property of body k that a state holds?
template <class T> bool isBodyState(const ArrayInfo<T>& array) {
  if constexpr (std::is_same_v<T, int>)
    if (array.member == &SolverData::idOf || array.member == &SolverData::placeOf) return false;
  return array.per == Per::Body && array.extra == 0 &&
         (array.life == Lifetime::Authored || array.life == Lifetime::State);
}

}  // namespace rubble::RUBBLE_CORE
