// The pattern of a relief baked over (u, v) and w, with roughness and light size in it (docs/theory.md, section 7):
// I(u, v, w) = Σ_r ψ_r(w) B_r(u, v) in XYZ, and order 0, which is sharper than a table, by a sum over spectral nodes.

uniform highp sampler2DArray uModes;        // B_r as coefficients of cubic B-splines: three layers a group of four modes
uniform highp sampler2D uModeWeights;       // ψ of the four modes of a group; w along x, a row a group
uniform highp sampler2D uCoherentPower;     // η_0 and its step to the next p = w/λ
uniform vec2 uPatternReach;                 // largest |u| and |v| of the table
uniform float uPatternRadius;               // standard deviation of the light that was baked in, rad

// Where two bilinear lookups along one axis read four texels with the weights of a cubic B-spline: their positions, in
// texels, and their shares. texel: where the spline is asked for, in texels.
void splineLookups(float texel, out vec2 position, out vec2 share) {
	float i = floor(texel);
	float t = texel - i;
	float t2 = t * t, t3 = t2 * t;
	// Weights of texels i − 1 to i + 2.
	vec4 b = vec4(1.0 - 3.0 * t + 3.0 * t2 - t3, 4.0 - 6.0 * t2 + 3.0 * t3, 1.0 + 3.0 * t + 3.0 * t2 - 3.0 * t3, t3) / 6.0;
	share = vec2(b.x + b.y, b.z + b.w);
	position = i + vec2(-1.0, 1.0) + vec2(b.y, b.w) / share;
}

// Σ_r ψ_r(w) B_r(u, v), XYZ.
vec3 modesColor(vec3 uvw) {
	if (any(greaterThan(abs(uvw.xy), uPatternReach))) return vec3(0.0);
	vec2 size = vec2(textureSize(uModes, 0).xy);
	vec2 texel = (0.5 + 0.5 * uvw.xy / uPatternReach) * (size - 1.0);
	vec2 x, y, shareX, shareY;
	splineLookups(texel.x, x, shareX);
	splineLookups(texel.y, y, shareY);
	x = (x + 0.5) / size.x;
	y = (y + 0.5) / size.y;
	float column = uvw.z / 2.0 * float(WEIGHT_SAMPLES - 1);
	int i = min(int(column), WEIGHT_SAMPLES - 2);
	float t = column - float(i);
	vec3 xyz = vec3(0.0);
	for (int group = 0; group < MODE_GROUPS; group++) {
		vec4 weights = mix(
			texelFetch(uModeWeights, ivec2(i, group), 0),
			texelFetch(uModeWeights, ivec2(i + 1, group), 0),
			t
		);
		for (int c = 0; c < 3; c++) {
			float layer = float(3 * group + c);
			// X, Y and Z of mode c, and one of them of the fourth mode.
			vec4 mode = shareY.x * (shareX.x * textureLod(uModes, vec3(x.x, y.x, layer), 0.0) + shareX.y * textureLod(uModes, vec3(x.y, y.x, layer), 0.0))
				+ shareY.y * (shareX.x * textureLod(uModes, vec3(x.x, y.y, layer), 0.0) + shareX.y * textureLod(uModes, vec3(x.y, y.y, layer), 0.0));
			xyz += weights[c] * mode.xyz;
			xyz[c] += weights.w * mode.w;
		}
	}
	return xyz;
}

// Order 0: Σ W η_0(w/λ) N((u, v); C) dλ, XYZ, C = λ²/(8π²σ²) + (wδ)² + α².
vec3 coherentColor(vec3 uvw) {
	float tilt = uvw.z * uRoughness;
	float blur = tilt * tilt + uPatternRadius * uPatternRadius;
	float d2 = dot(uvw.xy, uvw.xy);
	float widest = uWindowVariance / (WAVENUMBER_MIN * WAVENUMBER_MIN) + blur;
	int count = d2 < 2.0 * EXPONENT_CUT * widest ? LIGHT_NODES : 0;
	vec3 xyz = vec3(0.0);
	for (int k = 0; k < count; k++) {
		LitNode node = litNode(uLightNodes, k, vec3(1.0));
		float variance = node.wavelength * node.wavelength * uWindowVariance + blur;
		float column = min(uvw.z / node.wavelength / COHERENT_MAX, 1.0) * float(COHERENT_SAMPLES - 1);
		int i = int(column);
		vec2 power = texelFetch(uCoherentPower, ivec2(i, 0), 0).rg;
		float density = exp(-0.5 * d2 / variance) / (2.0 * PI * variance);
		xyz += node.color * (density * (power.r + (column - float(i)) * power.g));
	}
	return xyz;
}

// What the obliquity multiplies, XYZ. A tint multiplies it in linear sRGB: its spectrum is no longer known.
vec3 patternColor(vec3 wi, vec3 uvw, LightSpectrum light) {
	// Splines ring by some thousandths, which the obliquity blows up where directions graze.
	vec3 xyz = max(modesColor(uvw) + coherentColor(uvw), 0.0);
	#ifdef TINTED
	return inverse(uXyzToRgb) * (light.color * (uXyzToRgb * xyz));
	#else
	return light.color.g * xyz;  // grey: the three are equal
	#endif // TINTED
}
