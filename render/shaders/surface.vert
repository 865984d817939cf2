// A deformable surface: vertices and normals of this frame.
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 vertexNormal;
layout(location = 2) in float vertexHeat;  // 0 to 1: what its color tells
uniform mat4 viewProjection;
uniform int surfaceSlot;
flat out uint slot;
out vec3 normal;
out float heat;

void main() {
  slot = uint(surfaceSlot);
  normal = vertexNormal;
  heat = vertexHeat;
  gl_Position = viewProjection * vec4(position, 1.0);
}
