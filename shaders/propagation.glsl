// Which orders leave the surface, and how their efficiencies are normalised (docs/theory/gratings.md).
// Directions are in the grating's frame: x across the grooves, y along them, z the normal.
#include "efficiency.glsl"
#include "kirchhoff.glsl"
#include "lobe.glsl"

// First and last order m with |−ω_xy + m·shift·x̂| < radius, within the orders that the surface shows.
// direction: ω, unit; shift: λ/a; radius: 1 for the orders that propagate.
ivec2 ordersWithin(vec3 direction, float shift, float radius) {
	float reach = sqrt(max(radius * radius - direction.y * direction.y, 0.0));
	vec2 range = vec2(direction.x - reach, direction.x + reach) / shift;
	// clamp before the conversion: an integer of a huge float is undefined.
	range = clamp(vec2(ceil(range.x), floor(range.y)), -float(MAX_ORDER), float(MAX_ORDER));
	return ivec2(range);
}

// cos²θ of order m, below 0 where it does not propagate. offset: m·shift.
float orderSquaredCosine(vec3 direction, float offset) {
	float x = offset - direction.x;
	return 1.0 - x * x - direction.y * direction.y;
}

// cosθ of order m, 0 where it does not propagate.
float orderCosine(vec3 direction, float offset) {
	return sqrt(max(orderSquaredCosine(direction, offset), 0.0));
}

// w of an order, which its phase depth and its blur by tilted normals go with: conserving light, that of its middle, else
// of the two directions. uvw: ω_i + ω_o; offset: m·shift.
float orderDepth(vec3 uvw, vec3 wo, float offset) {
	#if defined(ENERGY_KIRCHHOFF) || defined(ENERGY_RECIPROCAL)
	return uvw.z;
	#else
	return wo.z + orderCosine(wo, offset);
	#endif // ENERGY
}

// A lobe whose middle is so many standard deviations below the horizon is not seen.
#define HORIZON_DEVIATIONS 4.2

// The part of a lobe above the horizon, Φ((1 − r)/c) within 0.002 and never less: light is not to be made.
// squaredCosine: 1 − r² of its middle, at two wavenumbers; sharpness: 1/c, c its standard deviation in directions.
vec2 aboveHorizon(vec2 squaredCosine, float sharpness) {
	// 1 − r = (1 − r²)/2 + (1 − r²)²/8 + …, and what makes it 1 at r = 0.
	vec2 up = max(squaredCosine, 0.0);
	vec2 z = squaredCosine * (0.5 + 0.125 * max(squaredCosine, -1.0) + 0.375 * up * up * up) * sharpness;
	// Φ(−|z|) to 0.00091, a fit; as much is added.
	vec2 away = -abs(z);
	vec2 t = clamp(1.0 + away / HORIZON_DEVIATIONS, 0.0, 1.0);
	vec2 t2 = t * t;
	vec2 tail = 0.5 * t2 * t2 * t * (1.0 - away * (0.4012 + 0.16397 * away));
	return mix(1.0 - tail, tail, lessThan(z, vec2(0.0))) + 0.00092 * min(4.0 * t, 1.0);
}

// The mean of 1/N(ω, s) over a lobe, N = Σ η_j H_j, H_j the part of order j's lobe above the horizon, each order at its own
// phase depth: the mean at one standard deviation to either side of the lobe's mean wavenumber. direction: ω; wavenumber,
// width: mean and standard deviation, 1/µm; frequency: 1/a, 1/µm.
float reciprocalEfficiency(vec3 direction, float wavenumber, float width, float frequency) {
	float shift = frequency / wavenumber;
	float window = uWindowVariance / (wavenumber * wavenumber);
	float tilt = direction.z * uRoughness;
	ivec2 orders = ordersWithin(direction, shift, 1.0 + HORIZON_DEVIATIONS * sqrt(window + tilt * tilt));
	float change = 2.0 * width / wavenumber;
	vec2 n = vec2(0.0);
	for (int m = orders.x; m <= orders.y; m++) {
		float offset = float(m) * shift;
		float squaredCosine = orderSquaredCosine(direction, offset);
		float w = direction.z + sqrt(max(squaredCosine, 0.0));
		float blur = w * uRoughness;
		float drift = change * offset * (offset - direction.x);
		n += orderEfficiency(m, reliefPhase(w, wavenumber))
			* aboveHorizon(squaredCosine + vec2(-drift, drift), inversesqrt(window + blur * blur));
	}
	// 1e-4: a relief can send all its light into orders that do not propagate; what scalar theory then says of the
	// rest is noise, and must not be divided by zero.
	n = max(n, 1e-4);
	return 0.5 * (n.x + n.y) / (n.x * n.y);
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
