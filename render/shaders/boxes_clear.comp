// An empty picture and empty lists.
#include "boxes.glsl"
#include "boxes_list.glsl"
layout(local_size_x = 256) in;
uniform int pixelCount;
uniform bool named;  // slots as well as depths

void main() {
  uint first = gl_GlobalInvocationID.x, step = gl_NumWorkGroups.x * gl_WorkGroupSize.x;
  for (uint i = first; i < uint(pixelCount); i += step) {
    depthBits[i] = kNoDepth;
    if (named) seenSlots[i] = kNoSlot;
  }
  if (first == 0u) {
    listed[0] = 0u;
    listed[1] = 0u;
  }
}
