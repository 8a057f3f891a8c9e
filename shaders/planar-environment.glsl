// Environment light on a flat surface: one table a grating, over the direction to the viewer (docs/theory/environments.md).
// PLANAR_TEXELS: along a side of a table.
#ifdef PLANAR_TEXELS
#include "planar-directions.glsl"

uniform highp sampler2DArray uPlanarEnvironment;  // XYZ under an environment of intensity 1, a layer a grating

// Radiance (XYZ) of a grating towards wo from the environment. wo: unit, view space; layer: the grating's number.
vec3 planarRadiance(SurfacePoint p, vec3 wo, int layer) {
	vec3 o = inFrame(p, wo);
	if (o.z <= 0.0) return vec3(0.0);
	vec3 place = vec3(squareFromHemisphere(o, PLANAR_TEXELS), layer);
	return uEnvironmentIntensity * textureLod(uPlanarEnvironment, place, 0.0).xyz;
}
#endif // PLANAR_TEXELS
