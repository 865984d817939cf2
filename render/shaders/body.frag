// What is seen in a pixel: slot + 1 of the body, and the normal where the body's pose does not tell it.
#include "pack.glsl"
flat in uint slot;
#ifdef MESH
in vec3 normal;
#endif
layout(location = 0) out uvec2 seen;

void main() {
#ifdef MESH
  seen = uvec2(slot + 1u, packNormal(normalize(normal)));
#else
  seen = uvec2(slot + 1u, 0u);
#endif
}
