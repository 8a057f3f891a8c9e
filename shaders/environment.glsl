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

// Radiance (linear sRGB, clamped at zero) arriving from a unit direction in view space, averaged over about
// `footprint`, a full width in rad; 0 reads level 0.
// The level is stated, never derived from pixel neighbours: on the seam of an equirectangular map they lie a whole
// turn apart. Negative texels come with some published environments; light cannot be negative.
vec3 environmentRadiance(vec3 directionView, float footprint) {
	vec3 world = (vec4(directionView, 0.0) * viewMatrix).xyz;
	vec3 direction = uEnvironmentRotation * world;
	float lod = log2(max(footprint / uEnvironmentTexel, 1.0));
	#ifdef ENVIRONMENT_CUBE
	vec3 radiance = textureLod(uEnvironmentMap, direction, lod).rgb;
	#else
	vec3 radiance = textureLod(uEnvironmentMap, equirectUv(direction), lod).rgb;
	#endif // ENVIRONMENT_CUBE
	return max(radiance, 0.0) * uEnvironmentIntensity;
}

// Irradiance (linear sRGB) on a plane with that normal, view space. An approximation by one mean over the width at
// half maximum of the cosine lobe, 2π/3: fit for the matt base, which has no detail to lose.
vec3 environmentIrradiance(vec3 normal) {
	return PI * environmentRadiance(normal, 2.0943951);
}

#endif // ENVIRONMENT_EQUIRECT, ENVIRONMENT_CUBE
