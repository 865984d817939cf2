// The camera. Depth d of the projection without a far plane: view depth = nearest / (1 - d).
uniform vec3 eye;
uniform vec3 forward;
uniform vec3 rightSpan;  // to the right edge of the picture at view depth 1
uniform vec3 upSpan;
uniform vec2 jitter;     // shift of the picture in normalised device coordinates
uniform float nearest;   // [m]

float viewDepth(float depth) { return nearest / max(1.0 - depth, 1e-9); }
vec3 rayAt(vec2 uv) {
  vec2 across = 2.0 * uv - 1.0 - jitter;
  return forward + across.x * rightSpan + across.y * upSpan;
}
