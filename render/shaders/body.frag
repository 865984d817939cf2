// What is seen in a pixel: slot + 1 of the body, and the normal where the body's pose does not tell it.
#include "pack.glsl"
flat in uint slot;
#ifdef MESH
in vec3 normal;
#ifdef HEAT
in float heat;
#endif
#endif
layout(location = 0) out uvec2 seen;

void main() {
#if defined(HEAT)
  seen = uvec2(slot + 1u, packHeat(normalize(normal), heat));
#elif defined(MESH)
  seen = uvec2(slot + 1u, packNormal(normalize(normal)));
#else
  seen = uvec2(slot + 1u, 0u);
#endif
}
