// Many bodies of one geometry in one draw: an instance is a chunk of consecutive slots, and the index buffer repeats the geometry for
// each of them. A vertex finds its body by its index.
#include "pose.glsl"
layout(location = 0) in uint firstSlot;
uniform mat4 viewProjection;
uniform int verticesPerBody;
uniform vec4 viewer;  // xyz: the eye and w = 1, or the direction to the light and w = 0

flat out uint slot;
#ifdef MESH
uniform samplerBuffer meshVertices;  // two texels each: position and how far the half length moves it along z; normal
out vec3 normal;
#endif

void main() {
  slot = firstSlot + uint(gl_VertexID / verticesPerBody);
  int vertex = gl_VertexID % verticesPerBody;
  vec4 size = texelFetch(looks, int(2u * slot));
  vec3 center = texelFetch(poses, int(2u * slot)).xyz;
  vec4 q = texelFetch(poses, int(2u * slot + 1u));
#ifdef MESH
  vec4 place = texelFetch(meshVertices, 2 * vertex);
  vec3 local = place.xyz * size.xyz + vec3(0.0, 0.0, place.w * size.w);
  normal = turned(q, normalize(texelFetch(meshVertices, 2 * vertex + 1).xyz / max(size.xyz, vec3(1e-9))));
#else
  // Only the three faces about the corner that is nearest the viewer are drawn; the index buffer has those about corner 7.
  vec3 toViewer = turnedBack(q, viewer.xyz - viewer.w * center);
  vec3 nearCorner = vec3(toViewer.x < 0.0 ? -1.0 : 1.0, toViewer.y < 0.0 ? -1.0 : 1.0, toViewer.z < 0.0 ? -1.0 : 1.0);
  vec3 corner = vec3(float(vertex & 1), float((vertex >> 1) & 1), float((vertex >> 2) & 1)) * 2.0 - 1.0;
  vec3 local = corner * nearCorner * size.xyz;
#endif
  gl_Position = viewProjection * vec4(center + turned(q, local), 1.0);
}
