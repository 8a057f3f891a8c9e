// Between three's loop over lights and the surface: three calls RE_Direct once a light, with shadows and distance
// already in the light's colour, and RE_IndirectDiffuse once.

struct LitSurface {
	SurfacePoint point;
	vec3 baseColor;     // albedo of the matt base, linear sRGB
	vec3 coatNormal;    // the lacquer's normal: smooth, whatever a normal map does below it
};

#include "diffracted-light.glsl"

// Sums over lights and environment.
vec3 baseRgb = vec3(0.0);
vec3 coatRgb = vec3(0.0);

#if LIGHT_COUNT > 0
void addLight(IncidentLight light, vec3 wo, LitSurface surface) {
	LightSpectrum spectrum = nextLight(light.color);
	// A dark light, or one in whose shadow this is, costs nothing.
	if (!light.visible || light.color == vec3(0.0)) return;
	vec3 wi = light.direction;
	float through = 1.0;
	#ifdef COAT
	through = coatTransmittance(dot(surface.coatNormal, wi)) * coatTransmittance(dot(surface.coatNormal, wo));
	coatRgb += coatRadianceFromLight(surface.coatNormal, wi, wo, spectrum);
	#endif // COAT
	#ifdef DIFFRACTION
	diffractedXyz += through * surfaceRadianceFromLight(surface.point, wi, wo, spectrum);
	#endif // DIFFRACTION
	#ifdef BASE
	float cosI = max(dot(surface.point.normal, wi), 0.0);
	baseRgb += through * cosI * light.color * BRDF_Lambert(surface.baseColor);
	#endif // BASE
}
#endif // LIGHT_COUNT

// Light from all sides. The way in has no one angle: the lacquer takes its share as on the way out, (1 − F(ω_o))².
void addIndirect(vec3 irradiance, vec3 wo, LitSurface surface) {
	float through = 1.0;
	#ifdef COAT
	through = coatTransmittance(dot(surface.coatNormal, wo));
	through *= through;
	#endif // COAT
	#ifdef ENVIRONMENT
	#ifdef COAT
	coatRgb += coatRadianceFromEnvironment(surface.coatNormal, wo);
	#endif // COAT
	#ifdef DIFFRACTION
	diffractedXyz += through * surfaceRadianceFromEnvironment(surface.point, wo);
	#endif // DIFFRACTION
	#endif // ENVIRONMENT
	#ifdef BASE
	#ifdef ENVIRONMENT
	irradiance += environmentIrradiance(surface.point.normal);
	#endif // ENVIRONMENT
	baseRgb += through * irradiance * BRDF_Lambert(surface.baseColor);
	#endif // BASE
}

#define RE_Direct(light, position, normal, wo, coatNormal, surface, sums) addLight(light, wo, surface)
#define RE_IndirectDiffuse(irradiance, position, normal, wo, coatNormal, surface, sums) addIndirect(irradiance, wo, surface)
