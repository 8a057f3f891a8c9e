// The environment as a rough plane sees it, over the direction of the light and, a layer each, cosθ_o of the viewer: tilts
// of deviation δ move the light's direction by w δ in the plane, w = cosθ_i + cosθ_o. A Gaussian, along x, then along y.
// Drawn with a camera that is not turned, so that view space is the world.
#include <common>

#include "environment.glsl"
#include "planar-directions.glsl"

uniform mat3 uPlane;                // tangent, bitangent, normal of the mesh: orthonormal columns, world
uniform float uCosine;              // cosθ_o of the layer
uniform float uRoughness;           // δ, rad
uniform vec2 uAxis;                 // along which to blur
uniform vec2 uTaps[BLUR_TAPS];      // moves in deviations, and their weights
uniform bool uIsBlurred;            // whether the first blur is done
uniform highp sampler3D uBlurredEnvironment;  // of the first blur

// Linear sRGB from a direction in the plane's frame. blur: full width of what one tap stands for, rad.
vec3 radianceFrom(vec3 direction, float blur) {
	if (!uIsBlurred) return environmentRadiance(uPlane * direction, blur);
	float layer = (0.5 + uCosine * (BLUR_LAYERS - 1.0)) / BLUR_LAYERS;
	return textureLod(uBlurredEnvironment, vec3(squareFromHemisphere(direction, BLUR_TEXELS), layer), 0.0).rgb;
}

void main() {
	vec3 i = hemisphereFromSquare(gl_FragCoord.xy / BLUR_TEXELS, BLUR_TEXELS);
	float deviation = (i.z + uCosine) * uRoughness;
	vec3 sum = vec3(0.0);
	for (int k = 0; k < BLUR_TAPS; k++) {
		vec2 moved = i.xy + deviation * uTaps[k].x * uAxis;
		moved /= max(length(moved), 1.0);
		vec3 direction = vec3(moved, sqrt(max(1.0 - dot(moved, moved), 0.0)));
		sum += uTaps[k].y * radianceFrom(direction, TAP_WIDTH * deviation);
	}
	// The largest half float: a sun may be brighter.
	gl_FragColor = vec4(min(sum, 65504.0), 1.0);
}
