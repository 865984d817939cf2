// Fainter where something is before it; edges fade over a pixel.
in vec4 color;  // a: half width [pixels]
noperspective in vec2 across;
uniform sampler2D depths;
uniform float nearest;
layout(location = 0) out vec4 shown;

const float kHidden = 0.28;  // opacity behind bodies
const float kNear = 0.004;   // how far behind a surface still counts as on it, over the view depth

void main() {
  float seen = nearest / max(1.0 - texelFetch(depths, ivec2(gl_FragCoord.xy), 0).x, 1e-9);
  float own = nearest / max(1.0 - gl_FragCoord.z, 1e-9);
  float cover = clamp(color.a + 0.5 - length(across), 0.0, 1.0);
  shown = vec4(color.rgb, cover * (own > seen * (1.0 + kNear) ? kHidden : 1.0));
}
