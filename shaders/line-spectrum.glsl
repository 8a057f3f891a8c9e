// The spectrum of a relief as lines, from the terms of a series.
#include "expansion.glsl"

uniform highp sampler2D uLightNodes;
uniform vec2 uPatch;  // periods along the patch's x and y, µm

#ifdef TILES
uniform ivec2 uTiles;               // how many patches the coherence window is cut to
uniform vec2 uCutVariance;          // of the Gaussians with the energy and the peak of the cut window's lobes, 1/µm²
uniform highp sampler2D uCutLobes;  // along x, step to the next |f|, along y, its step; a row for each share, the last one sharp

// Lobes along the patch's x and y over the peak of a Gaussian as wide: amplitudes or, where blurred, roots of powers.
// position: f in deviations; share: the window's of the deviation, 0 to 1.
vec2 cutLobes(float position, float share) {
	if (abs(position) > CUT_REACH) return vec2(0.0);
	float column = abs(position) / CUT_REACH * float(CUT_SAMPLES - 1);
	int i = int(column);
	#ifdef BLURRED
	float row = share * float(CUT_SHARES - 1);
	int k = min(int(row), CUT_SHARES - 2);
	vec4 below = texelFetch(uCutLobes, ivec2(i, k), 0), above = texelFetch(uCutLobes, ivec2(i, k + 1), 0);
	vec4 lobes = mix(below, above, row - float(k));
	#else
	vec4 lobes = texelFetch(uCutLobes, ivec2(i, CUT_SHARES), 0);
	#endif // BLURRED
	return lobes.rb + (column - float(i)) * lobes.ga;
}

// Indices of the lines within some distance of a frequency, none beyond the table. patchLength: µm; the others 1/µm.
ivec2 linesAbout(float frequency, float distance, float patchLength, int limit) {
	vec2 range = (frequency + vec2(-distance, distance)) * patchLength;
	// clamp before the conversion: an integer of a huge float is undefined.
	float most = float(limit);
	return ivec2(clamp(ceil(range.x), -most, most + 1.0), clamp(floor(range.y), -most - 1.0, most));
}

// |P|²/A at a wavenumber, 1/µm², behind a window cut to some patches: each line's lobe has tails, the longest along the
// axes. Powers of lines are added with blur, amplitudes without.
// blur: of lobeBlur; uvw: ω_i + ω_o; wavenumber: s, 1/µm.
float powerDensity(vec3 blur, vec3 uvw, float wavenumber) {
	vec3 c = vec3(uCutVariance, 0.0) + wavenumber * wavenumber * blur;
	float shear = c.z / c.x;
	vec2 deviation = sqrt(vec2(c.x, c.y - shear * c.z));
	vec2 share = min(sqrt(uCutVariance) / deviation, 1.0);
	float x = seriesArgument(uvw.z, wavenumber);
	vec2 centre = wavenumber * uvw.xy;
	ivec2 columns = linesAbout(centre.x, CUT_REACH * deviation.x, uPatch.x, LINES_X);
	vec2 amplitude = vec2(0.0);
	float power = 0.0;
	// Order 0, which outshines the others as a rule, comes first, with tails as far as the table goes.
	for (int j = columns.x - 1; j <= columns.y; j++) {
		bool isFirst = j < columns.x;
		float fx = centre.x - (isFirst ? 0.0 : float(j) / uPatch.x);
		float position = fx / deviation.x;
		float lobeX = cutLobes(position, share.x).x;
		if (!isFirst && abs(lobeX) < CUT_TAIL) continue;
		// A blur askew to the axes shears a Gaussian, but no tails.
		float middle = centre.y - shear * fx * 4.0 / max(position * position, 4.0);
		// Tails fall as 1/f: a product of two ends sooner.
		float reach = max(CUT_REACH * abs(lobeX), CUT_CORE) * deviation.y;
		ivec2 rows = isFirst ? ivec2(0) : linesAbout(middle, reach, uPatch.y, LINES_Y);
		for (int l = rows.x; l <= rows.y; l++) {
			float lobe = lobeX * cutLobes((middle - float(l) / uPatch.y) / deviation.y, share.y).y;
			if (!isFirst && (abs(lobe) < CUT_TAIL || (j | l) == 0)) continue;
			ivec2 index = isFirst ? ivec2(0) : ivec2(j, l);
			vec2 line = lobe * lineAmplitude(index, x).xy;
			#ifdef BLURRED
			power += dot(line, line);
			#else
			// The window's middle stands half as many patches from the first sample.
			bool isOdd = ((index.x * uTiles.x + index.y * uTiles.y) & 1) == 1;
			amplitude += isOdd ? -line : line;
			#endif // BLURRED
		}
	}
	#ifndef BLURRED
	power = dot(amplitude, amplitude);
	#endif // BLURRED
	return power / (2.0 * PI * deviation.x * deviation.y);
}
#else
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
			vec2 line = lineAmplitude(ivec2(j, l), x).xy;
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
#endif // TILES

// Irradiance's share of a node: the absolute BRDF has s² |P|²/A, the relative one that over a flat surface's s² · 4πσ² at
// normal incidence. wavenumber: s, 1/µm.
float perWavelength(float wavenumber) {
	#if defined(ENERGY_RELATIVE) && defined(TILES)
	return 2.0 * PI * sqrt(uCutVariance.x * uCutVariance.y);
	#elif defined(ENERGY_RELATIVE)
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
// (docs/theory/lights.md). Visits the lines along s(u, v), s over the visible range.
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
			// Two halves of the lobe, each with the colour and the power of its own mean wavenumber.
			float part = 0.70710678 * width * (1.0 + 4.0 * skew);
			vec4 below = lobeColor(middleS * (1.0 + skew) - part, part, tint);
			vec4 above = lobeColor(middleS * (1.0 + skew) + part, part, tint);
			float energyBelow = dot(below.xyz, vec3(1.0)), energyAbove = dot(above.xyz, vec3(1.0));
			float mean = (energyBelow * below.w + energyAbove * above.w) / max(energyBelow + energyAbove, 1e-9);
			vec4 amplitude = lineAmplitude(line, seriesArgument(uvw.z, mean));
			float power = dot(amplitude.xy, amplitude.xy);
			// Its magnitude is taken as a straight line: where it has a zero, its square is no such thing.
			float slope = dot(amplitude.xy, amplitude.zw) * seriesArgument(uvw.z, 1.0);
			vec2 powers = power + slope * (vec2(below.w, above.w) - mean);
			powers *= powers / max(power, 1e-12);
			powers *= vec2(perWavelength(below.w) / (below.w * below.w), perWavelength(above.w) / (above.w * above.w));
			// √(2π) q: the table has divided it out. dλ = ds/s².
			float lobe = 0.5 * 2.5066283 * width * exp(-exponent) / (2.0 * PI * sqrt(determinant));
			xyz += lobe * (powers.x * below.xyz + powers.y * above.xyz);
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
