// A map of gratings: orientation, frequency and strength at every texel. How a pixel that covers many texels shows the mean
// of their radiance depends on how many gratings there are: few have their shares, many are read one by one or in clusters.
// Without either a pixel shows the nearest texel, and so does the matt base without DIFFRACTION. Each of the three defines
// foilPointAt, on a frame that bumps may have bent.
#include "surface-point.glsl"

uniform vec2 uFoilRepeat;      // tiles along u and v

#ifdef DIFFRACTION
#include "grating.glsl"
#include "planar-environment.glsl"

// Number of the lowest bit that is set. A power of two is exact as a float, its exponent is the bit's number.
int lowestBit(uint bits) {
	return (floatBitsToInt(float(bits & (~bits + 1u))) >> 23) - 127;
}
#endif // DIFFRACTION

#if defined(DIFFRACTION) && defined(FOIL_GRATINGS)
#include "foil-shares.glsl"
#else
uniform sampler2D uFoilMap;    // cos 2θ, sin 2θ, frequency, strength, as stored
uniform vec4 uFoilOffset;      // value = offset + scale · texel; frequency in 1/µm
uniform vec4 uFoilScale;

// The grating of the texel at a place, in tiles: cos θ, sin θ, frequency in 1/µm, strength.
vec4 foilTexel(vec2 uv) {
	vec4 texel = uFoilOffset + uFoilScale * textureLod(uFoilMap, uv, 0.0);
	// Eight-bit steps leave (cos 2θ, sin 2θ) a little off the unit circle; texels without a grating hold zero.
	float length2 = dot(texel.xy, texel.xy);
	vec2 doubled = length2 > 0.0 ? texel.xy * inversesqrt(length2) : vec2(1.0, 0.0);
	// Half the angle, θ from −π/2 to π/2: orientation is known modulo π.
	vec2 direction = sqrt(max(0.5 + vec2(0.5, -0.5) * doubled.x, 0.0));
	if (doubled.y < 0.0) direction.y = -direction.y;
	return vec4(direction, max(texel.z, 0.0), clamp(texel.w, 0.0, 1.0));
}

#if defined(DIFFRACTION) && defined(FOIL_CLUSTERS)
#include "foil-clusters.glsl"
#else
SurfacePoint foilPointAt(vec3 tangent, vec3 bitangent, vec3 normal, vec2 uv) {
	vec4 texel = foilTexel(uv * uFoilRepeat);
	return SurfacePoint(
		texel.x * tangent + texel.y * bitangent,
		texel.x * bitangent - texel.y * tangent,
		normal, texel.z, texel.w, vec2(0.0)
	);
}

#ifdef DIFFRACTION
// Radiance (XYZ) towards wo from one light. wi, wo: unit, view space.
vec3 surfaceRadianceFromLight(SurfacePoint p, vec3 wi, vec3 wo, LightSpectrum light) {
	return gratingRadianceFromLight(p, wi, wo, light);
}

#ifdef ENVIRONMENT
// Radiance (XYZ) towards wo from the environment. wo: unit, view space.
vec3 surfaceRadianceFromEnvironment(SurfacePoint p, vec3 wo) {
	return gratingRadianceFromEnvironment(p, wo);
}
#endif // ENVIRONMENT
#endif // DIFFRACTION
#endif // DIFFRACTION, FOIL_CLUSTERS
#endif // DIFFRACTION, FOIL_GRATINGS

#ifdef FOIL_BUMPS
uniform sampler2D uFoilNormal;     // the normal's components along u and v over that along z, as stored
uniform vec2 uFoilNormalOffset;    // value = offset + scale · texel
uniform vec2 uFoilNormalScale;

// The frame of a bent surface. frame: orthonormal; uv: in tiles, 1. As without bumps the tangent is the direction in which u
// grows, projected into the plane of the normal. In components of the frame, with n ∝ (a, b, 1), that is ∝ (1 + b², −ab, −a),
// at right angles to (0, 1, −b); so mirrored uv need no sign, and a back side none: its frame is turned round as its relief is.
mat3 foilBent(mat3 frame, vec2 uv) {
	vec2 slope = uFoilNormalOffset + uFoilNormalScale * texture(uFoilNormal, uv).xy;
	vec3 normal = normalize(vec3(slope, 1.0));
	vec3 bitangent = normalize(vec3(0.0, 1.0, -slope.y));
	return frame * mat3(cross(bitangent, normal), bitangent, normal);
}
#endif // FOIL_BUMPS

// tangent, bitangent, normal: orthonormal, view space, tangent towards growing u; uv: texture coordinates, 1.
SurfacePoint surfacePointAt(vec3 tangent, vec3 bitangent, vec3 normal, vec2 uv) {
	#ifdef FOIL_BUMPS
	mat3 bent = foilBent(mat3(tangent, bitangent, normal), uv * uFoilRepeat);
	return foilPointAt(bent[0], bent[1], bent[2], uv);
	#else
	return foilPointAt(tangent, bitangent, normal, uv);
	#endif // FOIL_BUMPS
}
