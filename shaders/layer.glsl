// A diffracting surface on top of MeshStandardMaterial or MeshPhysicalMaterial: their loop over lights lights both, and
// the layer's light takes the place of theirs where it diffracts, under their clearcoat and sheen.
#include "tangent-frame.glsl"
#include "surface-point.glsl"
#include "environment.glsl"
#include "gamut.glsl"
#include "surface.glsl"
#include "diffracted-light.glsl"

uniform float uLayerStrength;  // share of the surface's own strength, 0 to 1

SurfacePoint layerPoint;

// Before the loop over lights. normal: unit, view space, towards the viewer; faceDirection: 1 on front faces, −1 on back faces.
void beginLayer(vec3 normal, float faceDirection) {
	mat3 frame = surfaceFrame(normal, faceDirection);
	layerPoint = surfacePointAt(frame[0], frame[1], frame[2], vUv);
}

#if LIGHT_COUNT > 0
// wo: unit, view space.
void addDiffracted(IncidentLight light, vec3 wo) {
	LightSpectrum spectrum = nextLight(light.color);
	if (!light.visible || light.color == vec3(0.0)) return;
	#ifdef DIFFRACTION
	diffractedXyz += surfaceRadianceFromLight(layerPoint, light.direction, wo, spectrum);
	#endif // DIFFRACTION
}

#undef RE_Direct
#define RE_Direct(light, position, normal, wo, coatNormal, material, sums) { \
	RE_Direct_Physical(light, position, normal, wo, coatNormal, material, sums); \
	addDiffracted(light, wo); \
}
#endif // LIGHT_COUNT

// After the loop. occlusion: share of the environment that is open, as three's ambient occlusion has it.
void addDiffractedEnvironment(vec3 wo, float occlusion) {
	#if defined(DIFFRACTION) && defined(ENVIRONMENT)
	diffractedXyz += occlusion * surfaceRadianceFromEnvironment(layerPoint, wo);
	#endif // DIFFRACTION, ENVIRONMENT
}

// Share of the surface that the layer covers, 0 to 1.
float layerShare() {
	#ifdef DIFFRACTION
	return uLayerStrength * layerPoint.strength;
	#else
	return 0.0;
	#endif // DIFFRACTION
}

// What leaves the layer (linear sRGB) where `base` would leave the material below it. Nothing of it shines through metal.
vec3 layered(vec3 base) {
	#ifdef DIFFRACTION
	vec3 rgb = uXyzToRgb * diffractedXyz;
	#ifdef GAMUT_MAPPED
	rgb = gamutMapped(rgb);
	#endif // GAMUT_MAPPED
	return mix(base, rgb, layerShare());
	#else
	return base;
	#endif // DIFFRACTION
}
