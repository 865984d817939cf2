/// Arrays over all worlds, and rays in them.
#include <algorithm>
#include <cstring>
#include <map>
#include <type_traits>

#include "cook/checks.h"
#include "world/worlds_impl.h"

namespace rubble {

ArrayView Worlds::Impl::gather(auto which, std::vector<std::byte>& to) {
  std::vector<ArrayView> views(batches.size());
  forEachBatch([&](std::size_t k) {
    if constexpr (std::is_same_v<decltype(which), JointArray> || std::is_same_v<decltype(which), SensorArray>)
      sendJointRows(k);
    else
      flush(k);
    views[k] = batches[k]->engine().array(which);
  });
  if (views.size() == 1 || (!views.empty() && views.front().device)) return views.front();
  ArrayView all;
  std::vector<std::size_t> begin{0};  // [bytes]
  for (const ArrayView& view : views) {
    begin.push_back(begin.back() + static_cast<std::size_t>(view.shape[0] * view.strides[0]));
    const std::int64_t rows = all.shape[0] + view.shape[0];
    all = view;
    all.shape[0] = rows;
  }
  to.resize(begin.back());
  forEachBatch([&](std::size_t k) {
    const auto* from = static_cast<const std::byte*>(views[k].data);
    std::copy_n(from, begin[k + 1] - begin[k], to.begin() + static_cast<std::ptrdiff_t>(begin[k]));
  });
  all.data = to.data();
  return all;
}

void Worlds::Impl::scatter(auto which, const std::vector<int>& begin, const ArrayView& rows,
                           const ArrayView& values) {
  if (rows.shape[0] == 0 || batches.empty()) return;
  if (values.device && !batches[0]->engine().poseCopies())
    throw Error("values", "host memory", "memory of a device");
  if (batches.size() == 1) return batches[0]->engine().scatter(which, rows, values);
  struct Part {
    std::vector<int> rows;
    std::vector<std::int64_t> from;  ///< rows of `values`
    std::vector<std::byte> values = {};
  };
  std::vector<Part> parts(batches.size());
  for (std::int64_t k = 0; k < rows.shape[0]; ++k) {
    int row;
    std::memcpy(&row, static_cast<const std::byte*>(rows.data) + k * rows.strides[0], sizeof row);
    if (row < 0 || row >= begin.back()) continue;
    const auto batch = static_cast<std::size_t>(std::ranges::upper_bound(begin, row) - begin.begin() - 1);
    parts[batch].rows.push_back(row - begin[batch]), parts[batch].from.push_back(k);
  }
  const auto row = static_cast<std::size_t>(values.strides[1] * values.shape[1]);
  for (Part& part : parts) {
    part.values.resize(part.rows.size() * row);
    for (std::size_t i = 0; i < part.rows.size(); ++i)
      std::memcpy(part.values.data() + i * row,
                  static_cast<const std::byte*>(values.data) + part.from[i] * values.strides[0], row);
  }
  // from here on there is memory for everything
  forEachBatch([&](std::size_t k) {
    if (parts[k].rows.empty()) return;
    ArrayView ownRows = rows, ownValues = values;
    ownRows.data = parts[k].rows.data(), ownRows.strides[0] = sizeof(int);
    ownValues.data = parts[k].values.data(), ownValues.strides[0] = static_cast<std::int64_t>(row);
    ownRows.shape[0] = ownValues.shape[0] = static_cast<std::int64_t>(parts[k].rows.size());
    batches[k]->engine().scatter(which, ownRows, ownValues);
  });
}

int Worlds::firstRow(int world) const {
  impl_->requireWorld(world);
  int rows = 0;
  for (int k = 0; k < world / impl_->perBatch; ++k)
    rows += impl_->batches[static_cast<std::size_t>(k)]->rows();
  const std::vector<int>& own = impl_->batchOf(world).rowsOf(world % impl_->perBatch);
  return own.empty() ? rows : rows + own.front();
}

std::vector<int> Worlds::rowsOf(int world) const {
  const int first = firstRow(world);
  std::vector<int> rows = withMemory("rowsOf",
                                     [&] { return impl_->batchOf(world).rowsOf(world % impl_->perBatch); });
  const int shift = rows.empty() ? 0 : first - rows.front();
  for (int& row : rows) row += shift;
  return rows;
}

ArrayView Worlds::array(StateArray which) const {
  checks::enumeration(which, StateArray::Torque, "array");
  return withMemory("array", [&] { return impl_->gather(which, impl_->arrays[static_cast<int>(which)]); });
}

void Worlds::scatter(StateArray which, const ArrayView& rows, const ArrayView& values) {
  withMemory("scatter", [&] {
    checkScatter(which, rows, values);
    std::vector<int> begin{0};
    for (const std::shared_ptr<Batch>& batch : impl_->batches) begin.push_back(begin.back() + batch->rows());
    impl_->forEachBatch([&](std::size_t k) { impl_->flush(k); });
    impl_->scatter(which, begin, rows, values);
  });
}

int Worlds::firstAxis(int world) const {
  impl_->requireWorld(world);
  const int own = world / impl_->perBatch;
  int rows = 0;
  for (int k = 0; k <= own; ++k) {
    const Batch& batch = *impl_->batches[static_cast<std::size_t>(k)];
    withMemory("firstAxis", [&] { impl_->sendJointRows(static_cast<std::size_t>(k)); });
    rows += batch.firstAxis(k < own ? batch.count() : world % impl_->perBatch);
  }
  return rows;
}

ArrayView Worlds::array(JointArray which) const {
  checks::enumeration(which, JointArray::AppliedForce, "array");
  if (which == JointArray::AppliedForce) throw Error("array", "an array that can be read", "another");
  return withMemory("array", [&] { return impl_->gather(which, impl_->axes[static_cast<int>(which)]); });
}

ArrayView Worlds::array(SensorArray which) const {
  checks::enumeration(which, SensorArray::JointTorque, "array");
  return withMemory("array", [&] { return impl_->gather(which, impl_->sensors[static_cast<int>(which)]); });
}

int Worlds::firstVertex(int world) const {
  impl_->requireWorld(world);
  const int own = world / impl_->perBatch;
  int rows = 0;
  for (int k = 0; k <= own; ++k) {
    const Batch& batch = *impl_->batches[static_cast<std::size_t>(k)];
    withMemory("firstVertex", [&] { impl_->flush(static_cast<std::size_t>(k)); });
    const int last = k < own ? batch.count() - 1 : world % impl_->perBatch;
    rows += batch.firstVertex(last) + (k < own ? batch.vertices(last) : 0);
  }
  return rows;
}

ArrayView Worlds::array(VertexArray which) const {
  checks::enumeration(which, VertexArray::Velocity, "array");
  return withMemory("array", [&] { return impl_->gather(which, impl_->vertices[static_cast<int>(which)]); });
}

void Worlds::scatter(JointArray which, const ArrayView& rows, const ArrayView& values) {
  withMemory("scatter", [&] {
    checkScatter(which, rows, values);
    impl_->forEachBatch([&](std::size_t k) { impl_->sendJointRows(k); });
    std::vector<int> begin{0};
    for (const std::shared_ptr<Batch>& batch : impl_->batches)
      begin.push_back(begin.back() + batch->firstAxis(batch->count()));
    impl_->scatter(which, begin, rows, values);
  });
}

ArrayView Worlds::contactForces(std::span<const std::array<int, 2>> rows) const {
  return withMemory("contactForces", [&] { return impl_->contactForces(rows); });
}

ArrayView Worlds::Impl::contactForces(std::span<const std::array<int, 2>> rows) {
  std::vector<int> begin{0};
  for (const std::shared_ptr<Batch>& batch : batches) begin.push_back(begin.back() + batch->rows());
  std::vector<std::vector<std::array<int, 2>>> pairs(batches.size());
  std::vector<std::vector<std::size_t>> from(pairs.size());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto [a, b] = rows[k];
    if (a < 0 || b < 0 || a >= begin.back() || b >= begin.back())
      throw Error("rows", "rows below " + std::to_string(begin.back()), std::to_string(std::max(a, b)));
    const auto batch = static_cast<std::size_t>(std::ranges::upper_bound(begin, a) - begin.begin() - 1);
    if (b < begin[batch] || b >= begin[batch + 1]) throw Error("rows", "two bodies of one world", "of two");
    pairs[batch].push_back({a - begin[batch], b - begin[batch]});
    from[batch].push_back(k);
  }
  std::vector<ArrayView> views(pairs.size());
  forEachBatch([&](std::size_t k) {
    if (pairs[k].empty()) return;
    flush(k);
    views[k] = batches[k]->engine().contactForces(pairs[k]);
  });
  if (views.size() == 1) return views[0];
  ArrayView all;
  for (std::size_t k = 0; k < views.size(); ++k) {
    if (pairs[k].empty()) continue;
    const auto row = static_cast<std::size_t>(views[k].strides[0]);
    all = views[k];
    pairForces.resize(rows.size() * row);
    for (std::size_t i = 0; i < from[k].size(); ++i)
      std::memcpy(pairForces.data() + from[k][i] * row,
                  static_cast<const std::byte*>(views[k].data) + i * row, row);
  }
  all.data = pairForces.data(), all.shape[0] = static_cast<std::int64_t>(rows.size());
  return all;
}

std::vector<RayHit> Worlds::castRays(std::span<const WorldRay> rays) {
  return withMemory("castRays", [&] { return impl_->castRays(rays); });
}

std::vector<RayHit> Worlds::Impl::castRays(std::span<const WorldRay> rays) {
  std::vector<RayHit> out(rays.size());
  std::vector<std::vector<std::size_t>> ofBatch(batches.size());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    requireWorld(rays[i].world);
    checkRay(rays[i].ray, i);
    ofBatch[static_cast<std::size_t>(rays[i].world / perBatch)].push_back(i);
  }
  forEachBatch([&](std::size_t k) {
    if (ofBatch[k].empty()) return;
    flush(k);
    Engine& engine = batches[k]->engine();
    const std::span<EngineQuery> queries = engine.queryRoom(ofBatch[k].size());
    for (std::size_t q = 0; q < queries.size(); ++q) {
      const auto& [world, ray] = rays[ofBatch[k][q]];
      queries[q] = queryOf(ray, at(world).registry);
      queries[q].world = world % perBatch;
    }
    const std::span<const EngineHit> hits = engine.hits({QueryKind::Ray, queries, {}});
    std::map<int, std::vector<std::size_t>> reachObjects;  // by world
    for (std::size_t q = 0; q < queries.size(); ++q) {
      const std::size_t i = ofBatch[k][q];
      out[i] = hitOf(hits[q], rays[i].ray, at(rays[i].world).registry);
      if (queries[q].deformables) reachObjects[rays[i].world].push_back(q);
    }
    for (const auto& entry : reachObjects) {
      const std::vector<std::size_t>& places = entry.second;
      const auto pick = [&](auto&& of) {
        std::vector<std::remove_cvref_t<decltype(of(0))>> list;
        for (const std::size_t q : places) list.push_back(of(q));
        return list;
      };
      std::vector<RayHit> merged = pick([&](std::size_t q) { return out[ofBatch[k][q]]; });
      std::vector<EngineQuery> own = pick([&](std::size_t q) { return queries[q]; });
      at(entry.first)
          .addObjectHits(own, pick([&](std::size_t q) { return hits[q]; }),
                         pick([&](std::size_t q) { return rays[ofBatch[k][q]].ray; }), merged);
      for (std::size_t n = 0; n < places.size(); ++n) out[ofBatch[k][places[n]]] = merged[n];
    }
  });
  return out;
}

}  // namespace rubble
