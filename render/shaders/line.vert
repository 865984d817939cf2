// A line of some pixels' width: four corners about the segment; a segment without length is a square.
layout(location = 0) in vec3 from;
layout(location = 1) in vec3 to;
layout(location = 2) in float width;  // pixels
layout(location = 3) in vec4 lineColor;
uniform mat4 viewProjection;
uniform float nearest;     // view depth that the part behind the eye is cut at [m]
uniform vec2 pixels;       // of the picture
uniform float widthScale;
out vec4 color;
noperspective out vec2 across;  // of the round dot: -1 to 1; of a line: y alone

void main() {
  vec4 a = viewProjection * vec4(from, 1.0), b = viewProjection * vec4(to, 1.0);
  // The clip coordinate w is the view depth.
  if (a.w < nearest && b.w >= nearest) a = mix(b, a, (b.w - nearest) / (b.w - a.w));
  if (b.w < nearest && a.w >= nearest) b = mix(a, b, (a.w - nearest) / (a.w - b.w));
  vec2 way = (b.xy / b.w - a.xy / a.w) * pixels;
  float isDot = dot(way, way) < 1e-4 ? 1.0 : 0.0;
  vec2 along = isDot > 0.5 ? vec2(1.0, 0.0) : normalize(way);
  vec2 side = vec2(-along.y, along.x);
  vec2 corner = vec2(gl_VertexID < 2 ? -1.0 : 1.0, (gl_VertexID & 1) == 0 ? -1.0 : 1.0);
  float reach = 0.5 * width * widthScale + 0.5;
  vec4 end = corner.x < 0.0 ? a : b;
  vec2 shift = (along * corner.x * (isDot > 0.5 ? 1.0 : 0.0) + side * corner.y) * reach * 2.0 / pixels;
  gl_Position = end + vec4(shift * end.w, 0.0, 0.0);
  across = corner * reach;
  if (isDot < 0.5) across.x = 0.0;
  // What is wholly behind the eye is not drawn.
  if (a.w < nearest) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
  color = vec4(lineColor.rgb, 0.5 * width * widthScale);
}
