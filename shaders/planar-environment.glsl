// Environment light on a flat surface: one table a grating, over the direction to the viewer (docs/theory.md, section 6).
// The hemisphere above the surface is folded out into a square: an octahedron's upper half, turned by an eighth
// (Cigolle et al. 2014, "A survey of efficient representations for independent unit vectors"). Its rim lies on the middles
// of the outermost texels, so that bilinear filtering never leaves it. PLANAR_TEXELS: along a side of the square.
#ifdef PLANAR_TEXELS

// Direction in the grating's frame (unit, z ≥ 0) → place in the square, 0 to 1.
vec2 squareFromHemisphere(vec3 direction) {
	vec2 p = direction.xy / (abs(direction.x) + abs(direction.y) + direction.z);
	vec2 square = vec2(p.x + p.y, p.x - p.y);
	return 0.5 + 0.5 * square * (1.0 - 1.0 / PLANAR_TEXELS);
}

// Its inverse. uv: place in the square, 0 to 1.
vec3 hemisphereFromSquare(vec2 uv) {
	vec2 square = (2.0 * uv - 1.0) / (1.0 - 1.0 / PLANAR_TEXELS);
	vec2 p = 0.5 * vec2(square.x + square.y, square.x - square.y);
	return normalize(vec3(p, max(1.0 - abs(p.x) - abs(p.y), 0.0)));
}

uniform highp sampler2DArray uPlanarEnvironment;  // XYZ of an environment of intensity 1, a layer a grating

// Radiance (XYZ) of a grating towards wo from the environment. wo: unit, view space; layer: the grating's number.
vec3 planarRadiance(SurfacePoint p, vec3 wo, int layer) {
	vec3 o = inFrame(p, wo);
	if (o.z <= 0.0) return vec3(0.0);
	return uEnvironmentIntensity * textureLod(uPlanarEnvironment, vec3(squareFromHemisphere(o), layer), 0.0).xyz;
}

#endif // PLANAR_TEXELS
