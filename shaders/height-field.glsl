// Diffraction by a relief that repeats: radiance from one light and from the environment (docs/theory/height-fields.md).
// Needs a SurfacePoint and LightSpectrum, and environmentRadiance() where ENVIRONMENT is defined.
#include "lobe.glsl"
#include "fresnel.glsl"
#include "kirchhoff.glsl"
#include "spectrum.glsl"

#ifdef DIELECTRIC
uniform float uReliefIor;  // refractive index, above 1
#endif // DIELECTRIC

#ifdef BAKED
#include "baked-pattern.glsl"
#else
#include "line-spectrum.glsl"
#endif // BAKED

// What of the reflectance depends on direction: a dielectric's, unpolarised, at the half vector. A metal's is in the
// nodes' colours. Relative: over that at normal incidence.
float reflectance(vec3 wi, vec3 wo) {
	#ifdef DIELECTRIC
	// Opposite directions, edge-on both: rounding may leave the sum below zero.
	float r = fresnelDielectric(sqrt(max(0.5 + 0.5 * dot(wi, wo), 0.0)), uReliefIor);
	#ifdef ENERGY_RELATIVE
	r /= fresnelDielectric(1.0, uReliefIor);
	#endif // ENERGY_RELATIVE
	return r;
	#else
	return 1.0;
	#endif // DIELECTRIC
}

// Radiance (XYZ) towards wo from one light: f_r cosθ_i times its irradiance. Zero below the horizon. wi, wo: unit, view
// space.
vec3 surfaceRadianceFromLight(SurfacePoint p, vec3 wi, vec3 wo, LightSpectrum light) {
	vec3 i = inFrame(p, wi);
	vec3 o = inFrame(p, wo);
	if (i.z <= 0.0 || o.z <= 0.0) return vec3(0.0);
	return i.z * kirchhoffFactor(i, o) * reflectance(i, o) * patternColor(i, i + o, light);
}

#ifdef ENVIRONMENT
#include "environment-samples.glsl"
#endif // ENVIRONMENT
