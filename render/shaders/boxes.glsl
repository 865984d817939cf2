// What compute leaves of the boxes of a view, a number a pixel, rows from below.
layout(std430, binding = 0) buffer Depths { uint depthBits[]; };  // of the nearest box, as the bits of a float: 0 to 1, and 1 where there is none
layout(std430, binding = 1) buffer Slots { uint seenSlots[]; };   // of that box
const uint kNoDepth = 0x3f800000u, kNoSlot = 0xffffffffu;
