// The visible part of a plane: rings about the foot of the eye, each wider than the last, so that depth stays exact near by.
#include "pose.glsl"
uniform mat4 viewProjection;
uniform vec3 eye;
uniform float reach;  // radius of the first ring [m]
uniform int planeSlot;
flat out uint slot;

const int kSectors = 48;

void main() {
  slot = uint(planeSlot);
  vec3 center = texelFetch(poses, 2 * planeSlot).xyz;
  vec4 q = texelFetch(poses, 2 * planeSlot + 1);
  vec3 normal = turned(q, vec3(0.0, 0.0, 1.0));
  vec3 foot = eye - normal * dot(eye - center, normal);
  int ring = gl_VertexID / kSectors, sector = gl_VertexID % kSectors;
  float angle = float(sector) * (6.283185307 / float(kSectors));
  float radius = ring == 0 ? 0.0 : reach * exp2(2.0 * float(ring - 1));
  vec3 across = turned(q, vec3(cos(angle), sin(angle), 0.0));
  gl_Position = viewProjection * vec4(foot + radius * across, 1.0);
}
