// A deformable surface: vertices and normals of this frame.
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 vertexNormal;
uniform mat4 viewProjection;
uniform int surfaceSlot;
flat out uint slot;
out vec3 normal;

void main() {
  slot = uint(surfaceSlot);
  normal = vertexNormal;
  gl_Position = viewProjection * vec4(position, 1.0);
}
