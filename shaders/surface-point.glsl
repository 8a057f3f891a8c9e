// What the material tells the optics, and all it tells it. Directions are in view space, lengths in µm.

struct SurfacePoint {
	vec3 tangent;     // grating vector: across the grooves, unit length
	vec3 bitangent;   // along the grooves, unit length
	vec3 normal;      // towards the viewer's side, unit length; the three are orthonormal
	float frequency;  // 1/period, 1/µm
	float strength;   // share of the surface that diffracts, 0 to 1
	vec2 spread;      // variances of grating vectors about their mean, along and across it, 1/µm²; read where GRATING_SPREAD is
};

// Components of a direction in view space along the surface's tangent, bitangent and normal.
vec3 inFrame(SurfacePoint p, vec3 direction) {
	return vec3(dot(direction, p.tangent), dot(direction, p.bitangent), dot(direction, p.normal));
}

struct LightSpectrum {
	vec3 color;           // irradiance on a plane that faces the light, linear sRGB
	float angularRadius;  // standard deviation of the light's Gaussian disc, rad
};
