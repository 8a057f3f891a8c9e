// Light from far away on all sides, as an equirectangular or a cube texture with mip levels.
#if defined(ENVIRONMENT_EQUIRECT) || defined(ENVIRONMENT_CUBE)
#define ENVIRONMENT

#ifdef ENVIRONMENT_CUBE
uniform samplerCube uEnvironmentMap;
#else
uniform sampler2D uEnvironmentMap;
#endif // ENVIRONMENT_CUBE
uniform mat3 uEnvironmentRotation;    // world → the texture's own directions
uniform float uEnvironmentIntensity;  // factor on its radiance
uniform float uEnvironmentTexel;      // angle between two texels of level 0, rad

// A direction in view space as the texture has it.
vec3 inEnvironment(vec3 directionView) {
	return uEnvironmentRotation * (vec4(directionView, 0.0) * viewMatrix).xyz;
}

// The mip level whose texel is as wide as a footprint; texels2: square of its full width in texels of level 0. The logarithm
// is that of a float's own bits, straight between powers of two: 0.04 of a level too low at most, and several times as fast.
float environmentLevel(float texels2) {
	float bits = float(floatBitsToInt(texels2));
	return max(0.5 * (bits / 8388608.0 - 127.0), 0.0);  // 23 bits of fraction; an exponent of 127 is 1
}

#if defined(ENVIRONMENT_EQUIRECT) || defined(BLURRED_LAYERS)
// Where three's equirectUv() puts a unit direction, to 2e-6 rad: the asin and atan of drivers may be off by far more, which
// moves sharp lamps by parts of a texel, and take longer. Polynomials of the least largest error:
// atan(r)/r in r² on [0, 1], acos(y)/√(1 − y) in y on [0, 1].
vec2 equirectAt(vec3 direction) {
	vec2 d = abs(direction.xz);
	float ratio = min(d.x, d.y) / max(max(d.x, d.y), 1e-20);
	float r2 = ratio * ratio;
	float turn = 0.05264720 - 0.01171907 * r2;
	turn = ratio * (0.99997722 + r2 * (-0.33262283 + r2 * (0.19354035 + r2 * (-0.11642637 + r2 * turn))));
	if (d.y > d.x) turn = 0.5 * PI - turn;
	if (direction.x < 0.0) turn = PI - turn;
	float y = min(abs(direction.y), 1.0);
	float rise = -0.04592714 + y * (0.02061994 - 0.00491112 * y);
	rise = 0.5 * PI - sqrt(1.0 - y) * (1.57079569 + y * (-0.21454282 + y * (0.08817103 + y * rise)));
	vec2 angles = vec2(direction.z < 0.0 ? -turn : turn, direction.y < 0.0 ? -rise : rise);
	return 0.5 + angles * vec2(RECIPROCAL_PI2, RECIPROCAL_PI);
}
#endif // ENVIRONMENT_EQUIRECT, BLURRED_LAYERS

// Radiance (linear sRGB, clamped at zero) from a unit direction of the texture's own, at a mip level.
// The level is stated, never derived from pixel neighbours: on the seam of an equirectangular map they lie a whole
// turn apart. Negative texels come with some published environments; light cannot be negative.
vec3 environmentTexels(vec3 direction, float level) {
	#ifdef ENVIRONMENT_CUBE
	vec3 radiance = textureLod(uEnvironmentMap, direction, level).rgb;
	#else
	vec3 radiance = textureLod(uEnvironmentMap, equirectAt(direction), level).rgb;
	#endif // ENVIRONMENT_CUBE
	return max(radiance, 0.0) * uEnvironmentIntensity;
}

// Radiance (linear sRGB) arriving from a unit direction in view space, averaged over about `footprint`, a full width in
// rad; 0 reads level 0.
vec3 environmentRadiance(vec3 directionView, float footprint) {
	float texels = footprint / uEnvironmentTexel;
	return environmentTexels(inEnvironment(directionView), environmentLevel(texels * texels));
}

// Irradiance (linear sRGB) on a plane with that normal, view space. An approximation by one mean over the width at
// half maximum of the cosine lobe, 2π/3: fit for the matt base, which has no detail to lose.
vec3 environmentIrradiance(vec3 normal) {
	return PI * environmentRadiance(normal, 2.0943951);
}

#include "blurred-environment.glsl"

#endif // ENVIRONMENT_EQUIRECT, ENVIRONMENT_CUBE
