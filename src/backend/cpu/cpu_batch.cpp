// Many worlds in the tables of a host engine.
#include "backend/cpu/cpu_engine.h"
#include "tables/world_places.h"

namespace rubble::RUBBLE_CORE {

namespace {

WorldPart worldPart(const WorldLayout& layout, int firstBody) {
  WorldPart part;
  part.firstBody = firstBody, part.bodies = static_cast<int>(layout.bodies.size());
  part.firstVertex = layout.first.vertex, part.vertices = layout.count.vertex;
  part.firstEdge = layout.first.edge, part.edges = layout.count.edge;
  part.firstFace = layout.first.face, part.faces = layout.count.face;
  part.firstAttachment = layout.firstAttachment, part.attachments = layout.attachments;
  std::ranges::copy(layout.first.element, part.firstElement);
  std::ranges::copy(layout.count.element, part.elements);
  std::ranges::copy(layout.joints, part.joints);
  part.shapes = layout.shapes, part.surfaces = layout.surfaces;
  return part;
}

}  // namespace

void CpuEngine::setLayout(std::span<const WorldLayout> worlds, std::span<const int> spare) {
  const int count = static_cast<int>(worlds.size());
  tables().reserve(Per::World, count);
  std::vector<int> order;  // ids in the order of their new places
  parts_.clear();
  for (const WorldLayout& world : worlds) {
    parts_.push_back(worldPart(world, static_cast<int>(order.size())));
    order.insert(order.end(), world.bodies.begin(), world.bodies.end());
  }
  order.insert(order.end(), spare.begin(), spare.end());
  placeBodies(tables(), order);
  SolverData& s = tables().view();
  s.worlds = count;
  for (int w = 0; w < count; ++w) {
    const WorldPart& part = parts_[static_cast<std::size_t>(w)];
    s.firstVertex[w] = part.firstVertex;
    s.paused[w] = 0;
    std::fill_n(&s.worldOfVertex[0] + part.firstVertex, part.vertices, w);
  }
  s.firstVertex[count] = s.vertices;
  worlds_.resize(worlds.size());
  arrays_.follow();
}

void CpuEngine::stepWorlds(StepReport& report, std::span<const char> paused) {
  SolverData& s = tables().view();
  std::vector<int> still;
  for (std::size_t w = 0; w < paused.size(); ++w)
    if ((s.paused[w] = paused[w]) != 0) still.push_back(static_cast<int>(w));
  // a step skips most of the work for paused worlds, and afterwards their states are put back
  std::vector<std::vector<std::byte>> states(still.size());
  executor_.run([&] {
    tbb::parallel_for(std::size_t{0}, still.size(), [&](std::size_t k) { states[k] = takeWorld(still[k]); });
  });
  s.pausing = !still.empty();
  try {
    step(report);
  } catch (...) {
    s.pausing = false;
    throw;
  }
  s.pausing = false;
  if (!still.empty()) putWorlds(still, std::vector<std::span<const std::byte>>(states.begin(), states.end()));
}

void CpuEngine::putWorlds(std::span<const int> worlds, std::span<const std::span<const std::byte>> states) {
  std::vector<WorldChange> changes;
  for (std::size_t k = 0; k < worlds.size(); ++k) changes.push_back({worlds[k], states[k]});
  RUBBLE_CORE::putWorlds(tables(), parts_, changes);
  arrays_.follow();
}

}  // namespace rubble::RUBBLE_CORE
