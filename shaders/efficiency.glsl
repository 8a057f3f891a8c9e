// The one place that knows how much light an order takes: a profile is data here, never a branch.

// η_m(φ) and its step to the next phase: phase along x (squared), order along y, from −TABLE_ORDER on, or from 0 where
// PROFILE_SYMMETRIC is defined: orders ±m of a symmetric profile take as much light as each other.
uniform highp sampler2D uEfficiencyTable;
uniform float uGratingHeight;              // h0, µm

// η_m(φ), the scalar efficiency of order m, whose lobe lies at u = mλ/a. phase: φ = 2π w h0/λ, rad, ≥ 0, held within
// the table (the material refuses heights that exceed it).
float orderEfficiency(int order, float phase) {
	#ifdef EFFICIENCY_TAYLOR
	// Second-order Taylor coefficients of a sinusoid (2018 holographic-surface paper, Eq. 2): small heights only.
	float b2 = 0.25 * phase * phase;
	int m = abs(order);
	if (m == 0) return (1.0 - 0.75 * b2) * (1.0 - 0.75 * b2) + b2;
	if (m == 1) return 0.25 * (b2 + b2 * b2);
	return m == 2 ? b2 * b2 / 64.0 : 0.0;
	#else
	float x = sqrt(min(phase / PHASE_MAX, 1.0)) * float(EFFICIENCY_PHASES - 1);
	int column = int(x);
	#ifdef PROFILE_SYMMETRIC
	int row = abs(order);
	#else
	int row = order + TABLE_ORDER;
	#endif // PROFILE_SYMMETRIC
	vec2 texel = texelFetch(uEfficiencyTable, ivec2(column, row), 0).rg;
	return texel.r + (x - float(column)) * texel.g;
	#endif // EFFICIENCY_TAYLOR
}

// φ = 2π w h0 s. w: sum of the cosines of both directions; wavenumber: s, 1/µm.
float reliefPhase(float w, float wavenumber) {
	return 2.0 * PI * w * uGratingHeight * wavenumber;
}
