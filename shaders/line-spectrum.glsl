// The spectrum of a relief as lines, from the terms of a series.
#include "expansion.glsl"

uniform vec2 uPatch;  // periods along the patch's x and y, µm

// |P|²/A at a wavenumber, 1/µm²: the lines near s(u, v), each a Gaussian as wide as the coherence window makes it.
// Without blur the lines' amplitudes are added, with blur their powers: then they no longer interfere.
// blur: of lobeBlur; uvw: ω_i + ω_o; wavenumber: s, 1/µm.
float powerDensity(vec3 blur, vec3 uvw, float wavenumber) {
	vec3 c = lobeCovariance(blur, wavenumber);
	float determinant = c.x * c.y - c.z * c.z;
	float x = seriesArgument(uvw.z, wavenumber);
	vec2 centre = wavenumber * uvw.xy;
	vec2 reach = sqrt(2.0 * EXPONENT_CUT * c.xy);
	ivec2 limit = ivec2(LINES_X, LINES_Y);
	// clamp before the conversion: an integer of a huge float is undefined.
	ivec2 first = ivec2(clamp(ceil((centre - reach) * uPatch), -vec2(limit), vec2(limit + 1)));
	ivec2 last = ivec2(clamp(floor((centre + reach) * uPatch), -vec2(limit + 1), vec2(limit)));
	vec2 amplitude = vec2(0.0);
	float power = 0.0;
	for (int l = first.y; l <= last.y; l++) {
		for (int j = first.x; j <= last.x; j++) {
			vec2 f = centre - vec2(j, l) / uPatch;
			float exponent = 0.5 * (c.y * f.x * f.x - 2.0 * c.z * f.x * f.y + c.x * f.y * f.y) / determinant;
			vec2 line = lineAmplitude(ivec2(j, l), x);
			#ifdef BLURRED
			power += exp(-exponent) * dot(line, line);
			#else
			amplitude += exp(-0.5 * exponent) * line;
			#endif // BLURRED
		}
	}
	#ifndef BLURRED
	power = dot(amplitude, amplitude);
	#endif // BLURRED
	return power / (2.0 * PI * sqrt(determinant));
}

// Irradiance's share of a node: the absolute BRDF has s² |P|²/A, the relative one that over a flat surface's s² · 4πσ² at
// normal incidence. wavenumber: s, 1/µm.
float perWavelength(float wavenumber) {
	#ifdef ENERGY_RELATIVE
	return 2.0 * PI * uWindowVariance;
	#else
	return wavenumber * wavenumber;
	#endif // ENERGY_RELATIVE
}

// ∫ W |P|²/A dλ by a sum over the nodes of the spectrum, XYZ.
vec3 sumOverNodes(vec3 blur, vec3 uvw, vec3 tint) {
	vec3 xyz = vec3(0.0);
	for (int k = 0; k < LIGHT_NODES; k++) {
		LitNode node = litNode(uLightNodes, k, tint);
		float s = 1.0 / node.wavelength;
		xyz += node.color * (powerDensity(blur, uvw, s) * perWavelength(s));
	}
	return xyz;
}

#ifdef LINE_SUM
// The same without a loop over wavelengths: each line is a grating of its own, whose lobe over wavenumber is a Gaussian
// (docs/theory.md, section 4). Visits the lines along s(u, v), s over the visible range.
// rho: |(u, v)|, above 0; spread: the largest deviation of a lobe in spatial frequency, 1/µm.
vec3 sumOverLines(vec3 blur, vec3 uvw, vec3 tint, float rho, float spread) {
	vec3 xyz = vec3(0.0);
	// Lines a unit of s along each axis; the axis with more of them leads.
	vec2 density = uvw.xy * uPatch;
	bool byX = abs(density.x) >= abs(density.y);
	float lead = byX ? density.x : density.y;
	float follow = byX ? density.y : density.x;
	float margin = LOBE_MARGIN * spread / rho;
	vec2 range = lead * vec2(WAVENUMBER_MIN - margin, WAVENUMBER_MAX + margin);
	if (lead < 0.0) range = range.yx;
	// A step of the other index moves a line this far from the ray, 1/µm.
	float apart = abs(byX ? uvw.x / uPatch.y : uvw.y / uPatch.x) / rho;
	float reach = sqrt(2.0 * EXPONENT_CUT) * spread / apart;
	ivec2 limit = byX ? ivec2(LINES_X, LINES_Y) : ivec2(LINES_Y, LINES_X);
	ivec2 leads = clamp(ivec2(ceil(range.x), floor(range.y)), -limit.x, limit.x);
	for (int j = leads.x; j <= leads.y; j++) {
		float middle = float(j) * follow / lead;
		vec2 near = vec2(ceil(middle - reach), floor(middle + reach));
		ivec2 follows = ivec2(clamp(near, -vec2(limit.y), vec2(limit.y)));
		for (int l = follows.x; l <= follows.y; l++) {
			ivec2 line = byX ? ivec2(j, l) : ivec2(l, j);
			vec2 g = vec2(line) / uPatch;
			// The covariance depends on s through the blur: taken where the sharp lobe would have its middle.
			float s = clamp(dot(g, uvw.xy) / (rho * rho), WAVENUMBER_MIN, WAVENUMBER_MAX);
			vec3 c = lobeCovariance(blur, s);
			float determinant = c.x * c.y - c.z * c.z;
			vec2 d = vec2(c.y * uvw.x - c.z * uvw.y, c.x * uvw.y - c.z * uvw.x);  // C⁻¹d · det C
			float adjugate = dot(d, uvw.xy);
			float width = sqrt(determinant / adjugate);
			float middleS = dot(d, g) / adjugate;
			float across = g.x * uvw.y - g.y * uvw.x;
			float exponent = 0.5 * across * across / adjugate;
			// As for gratings: a blurred lobe is a Gaussian in wavelength.
			float skew = (1.0 - uWindowVariance / c.x) * width * width / max(middleS * middleS, 0.25);
			vec4 color = lobeColor(middleS * (1.0 + skew), width * (1.0 + 4.0 * skew), tint);
			vec2 amplitude = lineAmplitude(line, seriesArgument(uvw.z, color.w));
			float power = exp(-exponent) * dot(amplitude, amplitude);
			// √(2π) q: the table has divided it out. dλ = ds/s².
			float lobe = 2.5066283 * width * power / (2.0 * PI * sqrt(determinant));
			xyz += color.xyz * (lobe * perWavelength(color.w) / (color.w * color.w));
		}
	}
	return xyz;
}
#endif // LINE_SUM

// ∫ W |P|²/A dλ times s² (relative: over a flat surface's), XYZ: what the obliquity multiplies. wi: ω_i; uvw: ω_i + ω_o.
vec3 patternColor(vec3 wi, vec3 uvw, LightSpectrum light) {
	vec3 blur = lobeBlur(wi, uvw.z, light.angularRadius);
	#ifdef LINE_SUM
	float tilt = uvw.z * uRoughness;
	float blurMax = tilt * tilt + light.angularRadius * light.angularRadius;
	float spread = sqrt(uWindowVariance + WAVENUMBER_MAX * WAVENUMBER_MAX * blurMax);
	float rho = length(uvw.xy);
	return spread > LOBE_WIDTH_MAX * rho
		? sumOverNodes(blur, uvw, light.color)
		: sumOverLines(blur, uvw, light.color, rho, spread);
	#else
	return sumOverNodes(blur, uvw, light.color);
	#endif // LINE_SUM
}
