// The shape of a diffraction lobe: a Gaussian whose width comes from the coherence window, from roughness and from the
// light's size (docs/theory/gratings.md). Directions are in the surface's frame, spatial frequencies in 1/µm.

uniform float uWindowVariance;  // 1/(8π²σ²), variance of the coherence window's lobe in spatial frequency, 1/µm²
#ifdef ROUGH
uniform float uRoughness;       // standard deviation of the normal's tilt, rad
#else
#define uRoughness 0.0
#endif // ROUGH

// Covariance of a lobe in the plane of (u, v) beyond that of the coherence window (xx, yy, xy).
// Normals tilted by ε move (u, v) by wε; a light's disc projects onto the surface. wi: ω_i; w: cosθ_i + cosθ_o.
// The disc's determinant is α⁴cos²θ_i; seen edge-on, float32 would leave a number of either sign of it. So the disc is
// given a thickness of √2e-6 of its radius: 2e-6 is four times what rounding makes of 1 − x² − y² where that is zero, and
// below 0.7 % of cos²θ_i up to 89°.
vec3 lobeBlur(vec3 wi, float w, float angularRadius) {
	float tilt = w * uRoughness;
	float source = angularRadius * angularRadius;
	return vec3(
		tilt * tilt + source * (1.000002 - wi.x * wi.x),
		tilt * tilt + source * (1.000002 - wi.y * wi.y),
		-source * wi.x * wi.y
	);
}

// Covariance of a lobe in spatial frequency (xx, yy, xy), 1/µm², at a wavenumber in 1/µm. blur: of lobeBlur.
vec3 lobeCovariance(vec3 blur, float wavenumber) {
	return vec3(uWindowVariance, uWindowVariance, 0.0) + wavenumber * wavenumber * blur;
}
