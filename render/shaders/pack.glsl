// A unit vector in 32 bits: octahedral map, 16 bits a coordinate; or 12 bits a coordinate and 8 bits for a number from 0 to 1.
vec2 toOctahedron(vec3 n) {
  n /= abs(n.x) + abs(n.y) + abs(n.z);
  vec2 side = vec2(n.x < 0.0 ? -1.0 : 1.0, n.y < 0.0 ? -1.0 : 1.0);
  return clamp((n.z >= 0.0 ? n.xy : (1.0 - abs(n.yx)) * side) * 0.5 + 0.5, 0.0, 1.0);
}
vec3 fromOctahedron(vec2 u) {
  vec2 e = u * 2.0 - 1.0;
  vec3 n = vec3(e, 1.0 - abs(e.x) - abs(e.y));
  float fold = max(-n.z, 0.0);
  n.xy += vec2(n.x < 0.0 ? fold : -fold, n.y < 0.0 ? fold : -fold);
  return normalize(n);
}
uint packNormal(vec3 n) {
  uvec2 u = uvec2(toOctahedron(n) * 65535.0 + 0.5);
  return u.x | (u.y << 16);
}
vec3 unpackNormal(uint bits) { return fromOctahedron(vec2(bits & 65535u, bits >> 16) / 65535.0); }
uint packHeat(vec3 n, float heat) {
  uvec2 u = uvec2(toOctahedron(n) * 4095.0 + 0.5);
  return u.x | (u.y << 12) | (uint(clamp(heat, 0.0, 1.0) * 255.0 + 0.5) << 24);
}
vec3 unpackHeat(uint bits, out float heat) {
  heat = float(bits >> 24) / 255.0;
  return fromOctahedron(vec2(bits & 4095u, (bits >> 12) & 4095u) / 4095.0);
}
