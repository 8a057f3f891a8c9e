// Which orders leave the surface, and how their efficiencies are normalised (docs/theory.md, section 2).
// Directions are in the grating's frame: x across the grooves, y along them, z the normal.
#include "efficiency.glsl"
#include "kirchhoff.glsl"

// First and last order m with |−ω_xy + m·shift·x̂| < 1, within the orders that the surface shows.
// direction: ω, unit; shift: λ/a.
ivec2 propagatingOrders(vec3 direction, float shift) {
	float reach = sqrt(max(1.0 - direction.y * direction.y, 0.0));
	vec2 range = vec2(direction.x - reach, direction.x + reach) / shift;
	// clamp before the conversion: an integer of a huge float is undefined.
	range = clamp(vec2(ceil(range.x), floor(range.y)), -float(MAX_ORDER), float(MAX_ORDER));
	return ivec2(range);
}

// cosθ of order m, 0 where it does not propagate.
float orderCosine(vec3 direction, float offset) {
	float x = offset - direction.x;
	return sqrt(max(1.0 - x * x - direction.y * direction.y, 0.0));
}

// The mean of 1/N(ω, s) over a lobe, N = Σ η_j over the orders that propagate, each at its own phase depth.
// Order j begins to propagate at s = |j|/a / (√(1 − ω_y²) + sgn(j) ω_x), where N steps; orders at whose step the
// lobe lies count for the share of the lobe beyond it. direction: ω; wavenumber, width: mean and standard deviation of
// the lobe, 1/µm; frequency: 1/a, 1/µm.
float reciprocalEfficiency(vec3 direction, float wavenumber, float width, float frequency) {
	float reach = sqrt(max(1.0 - direction.y * direction.y, 0.0));
	float shift = frequency / wavenumber;
	ivec2 orders = propagatingOrders(direction, frequency / (wavenumber + 1.25 * width));
	// A straight line of the normal distribution's slope at its middle: 0 and 1 at 1.25 standard deviations.
	float slope = 0.4 / width;
	float start = 0.5 + slope * wavenumber;
	vec2 steps = slope * frequency / max(reach + vec2(-direction.x, direction.x), 1e-6);  // of orders below and above 0
	float full = 0.0, partial = 0.0, share = 0.0;
	for (int m = orders.x; m <= orders.y; m++) {
		float order = float(m);
		float beyond = clamp(start - max(-order * steps.x, order * steps.y), 0.0, 1.0);
		float w = direction.z + orderCosine(direction, order * shift);
		float efficiency = orderEfficiency(m, reliefPhase(w, wavenumber));
		// Orders ±m step together where the light stands overhead.
		float stepping = beyond < 1.0 ? efficiency : 0.0;
		full += efficiency - stepping;
		partial += stepping;
		share += beyond * stepping;
	}
	share /= max(partial, 1e-12);
	// 1e-4: a relief can send all its light into orders that do not propagate; what scalar theory then says of the
	// rest is noise, and must not be divided by zero.
	return mix(1.0 / max(full, 1e-4), 1.0 / max(full + partial, 1e-4), share);
}

// What makes η_m the efficiency e_m/R, for light between wi and wo, over a lobe of mean wavenumber and width in 1/µm.
float energyFactor(vec3 wi, vec3 wo, float wavenumber, float width, float frequency) {
	#if defined(ENERGY_KIRCHHOFF)
	return kirchhoffFactor(wi, wo);
	#elif defined(ENERGY_RECIPROCAL)
	return min(
		reciprocalEfficiency(wi, wavenumber, width, frequency),
		reciprocalEfficiency(wo, wavenumber, width, frequency)
	);
	#else
	return reciprocalEfficiency(wo, wavenumber, width, frequency);
	#endif // ENERGY
}
