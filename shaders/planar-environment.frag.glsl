// Fills one layer of the table of planar-environment.glsl: what one grating in one plane shows of the environment in each
// direction, by the same function that a pixel would call. Drawn with a camera that is not turned.
#include <common>

#include "surface-point.glsl"
#include "planar-directions.glsl"

uniform mat3 uPlane;    // tangent, bitangent, normal of the mesh: orthonormal columns, world
uniform vec3 uGrating;  // cos θ, sin θ, frequency in 1/µm
uniform highp sampler3D uBlurredEnvironment;  // of planar-blur.frag.glsl

float viewCosine;  // cosθ_o

// In the place of environment.glsl's: the environment with the roughness in it, in the plane's frame. An arc's share adds
// little to that, so there are no levels.
#define uEnvironmentTexel 1.0

vec3 inEnvironment(vec3 direction) {
	return direction * uPlane;
}

float environmentLevel(float texels2) {
	return 0.0;
}

vec3 environmentTexels(vec3 i, float level) {
	float layer = (0.5 + viewCosine * (BLUR_LAYERS - 1.0)) / BLUR_LAYERS;
	vec2 square = squareFromHemisphere(vec3(i.xy, max(i.z, 0.0)), BLUR_TEXELS);
	return textureLod(uBlurredEnvironment, vec3(square, layer), 0.0).rgb;
}

vec3 environmentRadiance(vec3 direction, float footprint) {
	return environmentTexels(inEnvironment(direction), 0.0);
}

#define ENVIRONMENT
#include "grating.glsl"

void main() {
	SurfacePoint p = SurfacePoint(
		uGrating.x * uPlane[0] + uGrating.y * uPlane[1],
		uGrating.x * uPlane[1] - uGrating.y * uPlane[0],
		uPlane[2], uGrating.z, 1.0, vec2(0.0)
	);
	vec3 o = hemisphereFromSquare(gl_FragCoord.xy / PLANAR_TEXELS, PLANAR_TEXELS);
	// At the rim itself nothing is seen; what is filtered there is seen a little above it.
	o = normalize(vec3(o.xy, max(o.z, 0.5 / PLANAR_TEXELS)));
	viewCosine = o.z;
	vec3 xyz = gratingRadianceFromEnvironment(p, o.x * p.tangent + o.y * p.bitangent + o.z * p.normal);
	gl_FragColor = vec4(min(xyz, 65504.0), 1.0);
}
