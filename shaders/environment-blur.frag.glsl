// Fills one layer of blurred-environment.glsl from the layer before it, or, with one tap and no deviation, from the
// environment itself.
#include <common>

#include "environment.glsl"

uniform vec2 uSize;                  // of the layer, texels
uniform float uDeviation;            // rad
uniform vec2 uBlurTaps[BLUR_TAPS];   // along each axis: moves in deviations, and their weights
uniform float uLevel;                // mip level of the environment

void main() {
	vec2 angles = (gl_FragCoord.xy / uSize - 0.5) * vec2(2.0 * PI, PI);
	vec2 c = cos(angles), s = sin(angles);
	vec3 direction = vec3(c.y * c.x, s.y, c.y * s.x);
	vec3 east = vec3(-s.x, 0.0, c.x);
	vec3 north = vec3(-s.y * c.x, c.y, -s.y * s.x);
	vec3 sum = vec3(0.0);
	for (int j = 0; j < BLUR_TAPS; j++) {
		vec3 middle = direction + uDeviation * uBlurTaps[j].x * north;
		vec3 row = vec3(0.0);
		for (int i = 0; i < BLUR_TAPS; i++)
			row += uBlurTaps[i].y * environmentTexels(normalize(middle + uDeviation * uBlurTaps[i].x * east), uLevel);
		sum += uBlurTaps[j].y * row;
	}
	// The largest half float: there may be brighter suns.
	gl_FragColor = vec4(min(sum, 65504.0), 1.0);
}
