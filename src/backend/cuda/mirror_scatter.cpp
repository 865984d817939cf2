// Writes from arrays, on the device.
#include <cstring>

#include "backend/cuda/mirror.h"

namespace rubble::RUBBLE_CORE {

template <class Write>
void Mirror::withValues(const ArrayView& rows, const ArrayView& values, const Write& write) {
  const cudaStream_t stream = stepper_.stream();
  if (values.device) {
    // ordered after the caller's earlier work and before its later work
    order_.follow(values.stream);
    if (rows.stream != values.stream) order_.follow(rows.stream);
    write(rows, values);
    order_.lead(values.stream);
    if (rows.stream != values.stream) order_.lead(rows.stream);
    return;
  }
  const auto bytes = [](const ArrayView& view, int numbers) {
    return static_cast<std::size_t>(view.strides[0] * (view.shape[0] - 1) + view.strides[1] * numbers);
  };
  const std::size_t rowBytes = bytes(rows, 1),
                    valuesAt = (rowBytes + sizeof(double) - 1) / sizeof(double) * sizeof(double);
  const std::size_t valueBytes = bytes(values, static_cast<int>(values.shape[1]));
  std::byte* const to = upload_.begin(valuesAt + valueBytes);
  std::memcpy(to, rows.data, rowBytes);
  std::memcpy(to + valuesAt, values.data, valueBytes);
  const std::byte* const sent = upload_.send(stream);
  ArrayView rowsThere = rows, valuesThere = values;
  rowsThere.data = sent, valuesThere.data = sent + valuesAt;
  write(rowsThere, valuesThere);
}

void Mirror::scatter(StateArray which, const ArrayView& rows, const ArrayView& values) {
  const StreamOrder::Writing writing(order_);
  flush();
  withValues(rows, values, [&](const ArrayView& rowsThere, const ArrayView& valuesThere) {
    scatterStateRows(stepper_.stream(), present(), ScatterRows(which, rowsThere, valuesThere),
                     static_cast<int>(rows.shape[0]));
    followArrays();
  });
  scattered(which == StateArray::Force || which == StateArray::Torque);
}

void Mirror::scatter(JointArray which, const ArrayView& rows, const ArrayView& values) {
  const StreamOrder::Writing writing(order_);
  flush();
  withValues(rows, values, [&](const ArrayView& rowsThere, const ArrayView& valuesThere) {
    jointRows_.scatter(present(), which, rowsThere, valuesThere, stepper_.stream());
    followArrays();
  });
  const bool forces = which == JointArray::AppliedForce;
  if (!forces) targetsOnDevice_ = true, authored_.reset();
  scattered(forces);
}

void Mirror::scattered(bool forces) {
  for (const int slot : touched_) bits_[static_cast<std::size_t>(slot)] &= static_cast<std::uint8_t>(~kKnown);
  worldsRead_.clear();
  statesOld_ = restOld_ = true;
  forcesOnDevice_ |= forces, forced_ |= forces;
}

}  // namespace rubble::RUBBLE_CORE
