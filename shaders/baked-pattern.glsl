// The pattern of a relief baked over (u, v) and w, with roughness and light size in it (docs/theory/height-fields.md):
// I(u, v, w) = Σ_r ψ_r(w) B_r(u, v) in XYZ, and order 0, which turns with the light, from a table of its own.

uniform highp sampler2DArray uModes;    // B_r as coefficients of splines: three layers a group of four modes
uniform highp sampler2D uModeWeights;   // ψ of the four modes of a group; w along x, a row a group
uniform highp sampler2D uCoherent;      // E, XYZ: w along x, distance from the middle in deviations along y
uniform vec2 uPatternReach;             // largest |u| and |v| of the table
uniform float uPatternRadius;           // standard deviation of the light that was baked in, rad

// Σ_r ψ_r(w) B_r(u, v), XYZ. The splines are linear along u and cubic along v.
vec3 modesColor(vec3 uvw) {
	if (any(greaterThan(abs(uvw.xy), uPatternReach))) return vec3(0.0);
	vec2 size = vec2(textureSize(uModes, 0).xy);
	vec2 texel = (0.5 + 0.5 * uvw.xy / uPatternReach) * (size - 1.0);
	// Two lookups between texels read the four of a cubic B-spline with their weights, those of texels j − 1 to j + 2.
	float j = floor(texel.y);
	float t = texel.y - j;
	float t2 = t * t, t3 = t2 * t;
	vec4 b = vec4(1.0 - 3.0 * t + 3.0 * t2 - t3, 4.0 - 6.0 * t2 + 3.0 * t3, 1.0 + 3.0 * t + 3.0 * t2 - 3.0 * t3, t3) / 6.0;
	vec2 share = vec2(b.x + b.y, b.z + b.w);
	vec2 y = (j + vec2(-0.5, 1.5) + vec2(b.y, b.w) / share) / size.y;
	float x = (texel.x + 0.5) / size.x;
	float column = uvw.z / 2.0 * float(WEIGHT_SAMPLES - 1);
	int i = min(int(column), WEIGHT_SAMPLES - 2);
	float s = column - float(i);
	vec3 xyz = vec3(0.0);
	for (int group = 0; group < MODE_GROUPS; group++) {
		vec4 weights = mix(
			texelFetch(uModeWeights, ivec2(i, group), 0),
			texelFetch(uModeWeights, ivec2(i + 1, group), 0),
			s
		);
		for (int c = 0; c < 3; c++) {
			float layer = float(3 * group + c);
			// X, Y and Z of mode c, and one of them of the fourth mode.
			vec4 mode = share.x * textureLod(uModes, vec3(x, y.x, layer), 0.0)
				+ share.y * textureLod(uModes, vec3(x, y.y, layer), 0.0);
			xyz += weights[c] * mode.xyz;
			xyz[c] += weights.w * mode.w;
		}
	}
	return xyz;
}

// Order 0: E(r, w)/(2π √det C), XYZ. C: its covariance at the longest wavelength; r² = dᵀC⁻¹d.
vec3 coherentColor(vec3 wi, vec3 uvw) {
	vec3 c = lobeCovariance(lobeBlur(wi, uvw.z, uPatternRadius), WAVENUMBER_MIN) / (WAVENUMBER_MIN * WAVENUMBER_MIN);
	float determinant = c.x * c.y - c.z * c.z;
	float r2 = (c.y * uvw.x * uvw.x - 2.0 * c.z * uvw.x * uvw.y + c.x * uvw.y * uvw.y) / determinant;
	vec2 size = vec2(textureSize(uCoherent, 0));
	vec2 position = vec2(uvw.z / 2.0, sqrt(r2) / COHERENT_REACH);
	if (position.y > 1.0) return vec3(0.0);
	vec3 lobe = textureLod(uCoherent, (0.5 + position * (size - 1.0)) / size, 0.0).rgb;
	return lobe / (2.0 * PI * sqrt(determinant));
}

// What the obliquity multiplies, XYZ. A tint multiplies it in linear sRGB: its spectrum is no longer known.
vec3 patternColor(vec3 wi, vec3 uvw, LightSpectrum light) {
	// Splines ring by some thousandths, which the obliquity blows up where directions graze.
	vec3 xyz = max(modesColor(uvw) + coherentColor(wi, uvw), 0.0);
	#ifdef TINTED
	return inverse(uXyzToRgb) * (light.color * (uXyzToRgb * xyz));
	#else
	return light.color.g * xyz;  // grey: the three are equal
	#endif // TINTED
}
