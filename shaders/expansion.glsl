// Lines of a repeating relief's spectrum: exp(i k w h) as a series Σ_n c_n(x) i^n B_n(h), of Chebyshev polynomials with
// Bessel coefficients (Jacobi–Anger) or of powers (Taylor). Which it is, the tables know (docs/theory/height-fields.md).

uniform highp sampler2DArray uTerms;            // i^n F{B_n}: even n (re, im), odd n (re, im); line x ≥ 0, line y, pair of terms
uniform highp sampler2D uTermCoefficients;      // c_n, its step to the next x, for even n, then for odd n; x along x, pair along y
uniform float uReliefAmplitude;                 // x = 2π s w · amplitude, µm

// x of the series, rad. w: sum of the cosines of both directions; wavenumber: s, 1/µm.
float seriesArgument(float w, float wavenumber) {
	return 2.0 * PI * w * uReliefAmplitude * wavenumber;
}

// Complex amplitude A_jl of a line: the mean over the patch of exp(i k w h) exp(2πi (j x/Tx + l y/Ty)), but for a phase
// that all lines share, and (zw) its derivative dA/dx. line: (j, l), within the table; x: of seriesArgument, within the table.
vec4 lineAmplitude(ivec2 line, float x) {
	// Each B_n is real, so that its spectrum at −f is the conjugate of that at f: half a plane is stored.
	bool mirrored = line.x < 0;
	ivec2 texel = (mirrored ? -line : line) + ivec2(0, LINES_Y);
	float perRadian = float(SERIES_SAMPLES - 1) / SERIES_MAX;
	float column = min(x, SERIES_MAX) * perRadian;
	int i = int(column);
	float t = column - float(i);
	vec4 even = vec4(0.0), odd = vec4(0.0);
	// The later terms count where x is large.
	int pairs = min(TERM_PAIRS, int(SERIES_START + 0.5 * x));
	for (int pair = 0; pair < pairs; pair++) {
		vec4 c = texelFetch(uTermCoefficients, ivec2(i, pair), 0);
		vec4 term = texelFetch(uTerms, ivec3(texel, pair), 0);
		even += vec4((c.r + t * c.g) * term.rg, c.g * term.rg);
		odd += vec4((c.b + t * c.a) * term.ba, c.a * term.ba);
	}
	// The factor i^n is not conjugated with it.
	vec4 sum = mirrored ? vec4(even.x - odd.x, odd.y - even.y, even.z - odd.z, odd.w - even.w) : even + odd;
	return vec4(sum.xy, perRadian * sum.zw);
}
