// Into the picture what compute left of the boxes. NAMED: slots as well as depths.
#include "boxes.glsl"
uniform int across;  // pixels
#ifdef NAMED
layout(location = 0) out uvec2 seen;
#endif

void main() {
  int at = int(gl_FragCoord.y) * across + int(gl_FragCoord.x);
  uint bits = depthBits[at];
  if (bits == kNoDepth) discard;
  gl_FragDepth = uintBitsToFloat(bits);
#ifdef NAMED
  seen = uvec2(seenSlots[at] + 1u, 0u);
#endif
}
