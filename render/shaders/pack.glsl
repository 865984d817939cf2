// A unit vector in 32 bits: octahedral map, 16 bits a coordinate.
uint packNormal(vec3 n) {
  n /= abs(n.x) + abs(n.y) + abs(n.z);
  vec2 side = vec2(n.x < 0.0 ? -1.0 : 1.0, n.y < 0.0 ? -1.0 : 1.0);
  vec2 e = n.z >= 0.0 ? n.xy : (1.0 - abs(n.yx)) * side;
  uvec2 u = uvec2(clamp(e * 0.5 + 0.5, 0.0, 1.0) * 65535.0 + 0.5);
  return u.x | (u.y << 16);
}
vec3 unpackNormal(uint bits) {
  vec2 e = vec2(bits & 65535u, bits >> 16) / 65535.0 * 2.0 - 1.0;
  vec3 n = vec3(e, 1.0 - abs(e.x) - abs(e.y));
  float fold = max(-n.z, 0.0);
  n.xy += vec2(n.x < 0.0 ? fold : -fold, n.y < 0.0 ? fold : -fold);
  return normalize(n);
}
