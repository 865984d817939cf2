#pragma once
#include "io/recording.h"

namespace rubble::c {

/// Index of a frame. Throws Error if there is none.
int frameIndex(io::RecordingReader& reader, std::int64_t index);

}  // namespace rubble::c
