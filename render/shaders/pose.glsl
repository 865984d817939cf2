// Bodies: two texels of `poses` (center; quaternion, vector part first) and two of `looks` (size; color and finish) for each slot.
uniform samplerBuffer poses;
uniform samplerBuffer looks;

vec3 turned(vec4 q, vec3 v) {
  vec3 t = 2.0 * cross(q.xyz, v);
  return v + q.w * t + cross(q.xyz, t);
}
vec3 turnedBack(vec4 q, vec3 v) { return turned(vec4(-q.xyz, q.w), v); }
