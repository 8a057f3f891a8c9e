// One grating over the whole surface: grooves that run straight, or in circles about the middle of the uv square.
#include "surface-point.glsl"

uniform float uGratingFrequency;   // 1/period, 1/µm
uniform vec2 uGratingDirection;    // (cos, sin) of the angle from growing u (circular: from the radius) to the grating vector
uniform float uGratingStrength;    // share of the surface that diffracts, 0 to 1

// tangent, bitangent, normal: orthonormal, view space, tangent towards growing u; uv: texture coordinates, 1.
SurfacePoint surfacePointAt(vec3 tangent, vec3 bitangent, vec3 normal, vec2 uv) {
	#ifdef TRACKS_CIRCULAR
	// On the axis itself there is no radius; one pixel may take any.
	vec2 radius = uv - 0.5;
	float r2 = dot(radius, radius);
	radius = r2 > 0.0 ? radius * inversesqrt(r2) : vec2(1.0, 0.0);
	vec2 direction = vec2(
		uGratingDirection.x * radius.x - uGratingDirection.y * radius.y,
		uGratingDirection.y * radius.x + uGratingDirection.x * radius.y
	);
	#else
	vec2 direction = uGratingDirection;
	#endif // TRACKS_CIRCULAR
	return SurfacePoint(
		direction.x * tangent + direction.y * bitangent,
		direction.x * bitangent - direction.y * tangent,
		normal, uGratingFrequency, uGratingStrength, vec2(0.0)
	);
}

#ifdef DIFFRACTION
#include "grating.glsl"
#include "planar-environment.glsl"

// Radiance (XYZ) towards wo from one light. wi, wo: unit, view space.
vec3 surfaceRadianceFromLight(SurfacePoint p, vec3 wi, vec3 wo, LightSpectrum light) {
	return gratingRadianceFromLight(p, wi, wo, light);
}

#ifdef ENVIRONMENT
// Radiance (XYZ) towards wo from the environment. wo: unit, view space.
vec3 surfaceRadianceFromEnvironment(SurfacePoint p, vec3 wo) {
	#ifdef PLANAR_TEXELS
	return planarRadiance(p, wo, 0);
	#else
	return gratingRadianceFromEnvironment(p, wo);
	#endif // PLANAR_TEXELS
}
#endif // ENVIRONMENT
#endif // DIFFRACTION
