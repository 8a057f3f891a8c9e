// Diffraction by a grating: radiance from one light and from the environment (docs/theory/lights.md and environments.md).
// Needs a SurfacePoint and LightSpectrum, and environmentRadiance() where ENVIRONMENT is defined.
#include "lobe.glsl"
#include "spectrum.glsl"
#include "propagation.glsl"

uniform highp sampler2D uLightNodes;
#ifdef ENVIRONMENT
uniform highp sampler2D uEnvironmentNodes;
uniform int uEnvironmentStart;  // column of the first node
#endif // ENVIRONMENT

// Standard deviation of a node's band, a box, over its width.
#define BAND_DEVIATION 0.2886751

// Covariance of order m's lobe in spatial frequency, 1/µm²: that of every lobe, and m² times that of the grating vectors
// about their mean. blur: of lobeBlur; s: a wavenumber in 1/µm.
vec3 orderCovariance(SurfacePoint p, vec3 blur, float s, float m) {
	vec3 covariance = lobeCovariance(blur, s);
	#ifdef GRATING_SPREAD
	covariance.xy += m * m * p.spread;
	#endif // GRATING_SPREAD
	return covariance;
}

#ifdef WAVELENGTH_LOOP
// The seed's method: Σ over wavelengths and all orders of S e_m N(s(u, v) − (m/a, 0); C) ds, XYZ in 1/sr.
vec3 lobesByWavelength(SurfacePoint p, vec3 wi, vec3 wo, float angularRadius, vec3 tint) {
	float frequency = p.frequency;
	vec3 uvw = wi + wo;
	vec3 xyz = vec3(0.0);
	for (int i = 0; i < LIGHT_NODES; i++) {
		LitNode node = litNode(uLightNodes, i, tint);
		float s = 1.0 / node.wavelength;
		float sum = 0.0;
		for (int m = -MAX_ORDER; m <= MAX_ORDER; m++) {
			float g = float(m) * frequency;
			float w = orderDepth(uvw, wo, g / s);
			vec3 c = orderCovariance(p, lobeBlur(wi, w, angularRadius), s, float(m));
			float sharpness = inversesqrt(c.x * c.y - c.z * c.z);
			vec2 f = sharpness * (s * uvw.xy - vec2(g, 0.0));
			float exponent = 0.5 * (c.y * f.x * f.x - 2.0 * c.z * f.x * f.y + c.x * f.y * f.y);
			if (exponent < EXPONENT_CUT) sum += exp(-exponent) * sharpness * orderEfficiency(m, reliefPhase(w, s));
		}
		if (sum > 0.0) {
			// dλ of the band times s² N = N ds.
			float density = s * s * sum / (2.0 * PI);
			float factor = energyFactor(wi, wo, s, BAND_DEVIATION * s * s * node.bandwidth, frequency);
			xyz += node.color * (density * factor);
		}
	}
	return xyz;
}
#else
// Lobes without a loop over the visible spectrum, XYZ in 1/sr. With d = (u, v), g = (m/a, 0) and C a lobe's covariance in
// spatial frequency, its density over wavenumber is N(s d − g; C):
// - narrow lobes, one an order: a Gaussian in s about s* = dᵀC⁻¹g/dᵀC⁻¹d with variance q² = 1/dᵀC⁻¹d, times
//   exp(−½ (g × d)²/(det C · dᵀC⁻¹d)); the spectrum's average over it is a lookup.
// - wide lobes (order 0 always is, where it is seen): a sum over few spectral nodes; where WIDE_LOBES is defined, of all
//   orders at each, else no other order can be wide.
// Both share one loop body: a program that runs both sides of a branch, as software and divergent pixels do, pays once.
vec3 lobesInClosedForm(
	SurfacePoint p, vec3 wi, vec3 wo, float angularRadius, ivec2 orders, bool wide, vec3 tint
) {
	float frequency = p.frequency;
	vec3 uvw = wi + wo;
	float u = uvw.x, v = uvw.y;
	vec3 xyz = vec3(0.0);
	int count = wide ? LIGHT_NODES : orders.y - orders.x + 1;
	for (int k = 0; k < count; k++) {
		int m = wide ? 0 : orders.x + k;
		float g = float(m) * frequency;
		LitNode node = litNode(uLightNodes, min(k, LIGHT_NODES - 1), tint);
		// C depends on s through the blur; for a narrow lobe it is taken where the sharp one would have its middle.
		float s = wide ? 1.0 / node.wavelength : clamp(g * u / (u * u + v * v), WAVENUMBER_MIN, WAVENUMBER_MAX);
		float w = orderDepth(uvw, wo, g / s);
		vec3 c = orderCovariance(p, lobeBlur(wi, w, angularRadius), s, float(m));
		float sharpness = inversesqrt(c.x * c.y - c.z * c.z);  // 1/√(det C)
		float adjugate = c.y * u * u - 2.0 * c.z * u * v + c.x * v * v;  // dᵀC⁻¹d · det C
		float width = wide ? BAND_DEVIATION * s * s * node.bandwidth : inversesqrt(adjugate) / sharpness;
		vec4 color = vec4(node.color, s);
		if (!wide) {
			// To first order in its relative variance a blurred lobe, a Gaussian in wavelength, is one in wavenumber that is
			// shifted and widened by as much as the blur's share of it.
			float middle = g * (c.y * u - c.z * v) / adjugate;
			float blurred = c.x - orderCovariance(p, vec3(0.0), s, float(m)).x;
			float skew = blurred / c.x * width * width / max(middle * middle, 0.25);
			color = lobeColor(middle * (1.0 + skew), width * (1.0 + 4.0 * skew), tint);
		}
		float across = 0.5 * g * g * v * v / adjugate;  // a narrow lobe's exponent
		#ifdef WIDE_LOBES
		float sum = 0.0;
		ivec2 range = wide ? orders : ivec2(m);
		for (int j = range.x; j <= range.y; j++) {
			float exponent = across;
			if (wide) {
				float offset = float(j) * frequency;
				w = orderDepth(uvw, wo, offset / s);
				c = orderCovariance(p, lobeBlur(wi, w, angularRadius), s, float(j));
				sharpness = inversesqrt(c.x * c.y - c.z * c.z);
				vec2 f = sharpness * (s * uvw.xy - vec2(offset, 0.0));
				exponent = 0.5 * (c.y * f.x * f.x - 2.0 * c.z * f.x * f.y + c.x * f.y * f.y);
			}
			if (exponent < EXPONENT_CUT)
				sum += exp(-exponent) * sharpness * orderEfficiency(j, reliefPhase(w, color.w));
		}
		#else
		float exponent = wide ? 0.5 * s * s * sharpness * sharpness * adjugate : across;
		float sum = exponent < EXPONENT_CUT
			? exp(-exponent) * sharpness * orderEfficiency(m, reliefPhase(w, color.w))
			: 0.0;
		#endif // WIDE_LOBES
		// ds: a node's band is dλ = ds/s²; a Gaussian's is √(2π) q, which the table has divided out.
		float ds = wide ? s * s : 2.5066283 * width;
		float density = ds * sum / (2.0 * PI);
		float factor = density > 0.0 ? energyFactor(wi, wo, color.w, width, frequency) : 0.0;
		xyz += color.xyz * (density * factor);
	}
	return xyz;
}
#endif // WAVELENGTH_LOOP

// Radiance (XYZ) towards wo from one light: f_r cosθ_i times its irradiance. Zero below the horizon. wi, wo: unit, view
// space.
vec3 gratingRadianceFromLight(SurfacePoint p, vec3 wi, vec3 wo, LightSpectrum light) {
	vec3 i = inFrame(p, wi);
	vec3 o = inFrame(p, wo);
	if (i.z <= 0.0 || o.z <= 0.0 || p.frequency <= 0.0) return vec3(0.0);
	vec3 uvw = i + o;
	#ifdef WAVELENGTH_LOOP
	return i.z * lobesByWavelength(p, i, o, light.angularRadius, light.color);
	#else
	// A pixel far from the line v = 0 sees no order at any visible wavelength: the lobe is widest at the longest one.
	float sLow = WAVENUMBER_MIN, sHigh = WAVENUMBER_MAX;
	// No order's w is more than wo.z + 1.
	float varianceV = uWindowVariance / (sLow * sLow) + lobeBlur(i, o.z + 1.0, light.angularRadius).y;
	#ifdef GRATING_SPREAD
	// No order lies further out than m λ/a = 2.
	varianceV += 4.0 / (p.frequency * p.frequency) * p.spread.y;
	#endif // GRATING_SPREAD
	if (uvw.y * uvw.y > 2.0 * EXPONENT_CUT * varianceV) return vec3(0.0);
	// Largest standard deviation of a lobe in spatial frequency.
	float tilt = uvw.z * uRoughness;
	float variance = uWindowVariance + sHigh * sHigh * (tilt * tilt + light.angularRadius * light.angularRadius);
	float rho = length(uvw.xy);
	#ifdef GRATING_SPREAD
	// Of the highest order in reach.
	float highest = min(sHigh * rho * rho / (max(abs(uvw.x), 1e-6) * p.frequency), float(MAX_ORDER));
	variance += highest * highest * p.spread.x;
	#endif // GRATING_SPREAD
	float spread = sqrt(variance);
	bool wide = spread > LOBE_WIDTH_MAX * rho;
	// Orders m/a in reach, for u ≥ 0. Wide: s·u within the exponent's cut for some visible
	// s. Narrow: the lobe's middle (m/a) u/ρ² within its table's margin of the visible range.
	float stretch = wide ? abs(uvw.x) : rho * rho / max(abs(uvw.x), 1e-6);
	float slack = wide ? sqrt(2.0 * EXPONENT_CUT) * spread : LOBE_MARGIN * spread * stretch / rho;
	vec2 range = vec2(sLow * stretch - slack, sHigh * stretch + slack) / p.frequency;
	if (uvw.x < 0.0) range = -range.yx;
	range = clamp(range, -float(MAX_ORDER), float(MAX_ORDER));
	ivec2 orders = ivec2(ceil(range.x), floor(range.y));
	if (orders.x > orders.y) return vec3(0.0);
	return i.z * lobesInClosedForm(p, i, o, light.angularRadius, orders, wide, light.color);
	#endif // WAVELENGTH_LOOP
}

#ifdef ENVIRONMENT
#ifdef BLURRED_LAYERS
// Radiance (linear sRGB) of an order that tilts of deviation δ move by w δ on all sides in the plane: as an angle that is as
// much across, and 1/cosθ of it along the radius. What is more than a round blur is to move outwards or inwards; of many
// readings half do the one, half the other (docs/theory/environments.md). plane: the direction's part in the surface, up: the
// normal, both in the environment's axes; squared: |plane|²; move: ± w δ; spread: of the reading itself, a variance, rad².
vec3 tiltedRadiance(vec3 plane, vec3 up, float squared, float move, float spread) {
	// Held at the horizon.
	float scale = min(1.0 + move, inversesqrt(max(squared, 1e-12)));
	float z = sqrt(max(1.0 - scale * scale * squared, 0.0));
	return blurredRadiance(scale * plane + z * up, move * move + spread);
}
#endif // BLURRED_LAYERS

#ifdef WAVELENGTH_LOOP
// The papers' method: at each wavelength the mean of what the propagating orders see, weighted by their efficiencies.
// XYZ. o: ω_o in the grating's frame; mirror: radiance that order 0 sees, linear sRGB.
vec3 arcsOfEnvironment(SurfacePoint p, vec3 o, vec3 mirror) {
	vec3 xyz = vec3(0.0);
	for (int j = 0; j < ENVIRONMENT_NODES; j++) {
		SpectralNode node = spectralNode(uEnvironmentNodes, uEnvironmentStart + j);
		float s = 1.0 / node.wavelength;
		float shift = p.frequency * node.wavelength;
		ivec2 orders = ordersWithin(o, shift, 1.0);
		float width = BAND_DEVIATION * s * s * node.bandwidth;
		vec3 seen = vec3(0.0);
		float total = 0.0;
		for (int m = orders.x; m <= orders.y; m++) {
			float z = orderCosine(o, float(m) * shift);
			vec3 i = vec3(float(m) * shift - o.x, -o.y, z);
			float efficiency = orderEfficiency(m, reliefPhase(o.z + z, s));
			total += efficiency;
			#if defined(ENERGY_KIRCHHOFF) || defined(ENERGY_RECIPROCAL)
			efficiency *= energyFactor(i, o, s, width, p.frequency);
			#endif // ENERGY
			vec3 radiance = mirror;
			if (m != 0) {
				float footprint = 2.0 * (o.z + z) * uRoughness;
				radiance = environmentRadiance(p.tangent * i.x + p.bitangent * i.y + p.normal * i.z, footprint);
			}
			seen += efficiency * radiance;
		}
		#if !defined(ENERGY_KIRCHHOFF) && !defined(ENERGY_RECIPROCAL)
		// The mean needs no floor as the light's lobes do: what is divided has the same factor.
		seen /= max(total, 1e-12);
		#endif // ENERGY
		xyz += node.tints * seen;
	}
	return xyz;
}
#else
// Likewise, but at nodes whose tints estimate the whole spectrum (web/spectrum/arc-nodes.ts), each reading filtered over its
// share of the arc. An order's directions differ in two components alone, and are put together in the environment's own
// axes. What does not change along a loop is taken out of it: not every compiler does.
vec3 arcsOfEnvironment(SurfacePoint p, vec3 o, vec3 mirror) {
	vec3 across = inEnvironment(p.tangent);
	vec3 along = -o.y * inEnvironment(p.bitangent);
	vec3 up = inEnvironment(p.normal);
	float open = 1.0 - o.y * o.y;
	#ifdef BLURRED_LAYERS
	float unit = 1.0;  // variances are in rad²
	int frame = uEnvironmentStart / ENVIRONMENT_NODES;
	#else
	// A mip level read bilinearly blurs as a Gaussian of half its texel: footprint = 2 standard deviations, in texels here.
	float unit = 2.0 / uEnvironmentTexel;
	float tilt2 = unit * uRoughness * unit * uRoughness;
	#endif // BLURRED_LAYERS
	#ifdef GRATING_SPREAD
	float spread2 = unit * unit * max(p.spread.x, p.spread.y);
	#endif // GRATING_SPREAD
	vec3 xyz = vec3(0.0);
	for (int j = 0; j < ENVIRONMENT_NODES; j++) {
		SpectralNode node = spectralNode(uEnvironmentNodes, uEnvironmentStart + j);
		float s = 1.0 / node.wavelength;
		float shift = p.frequency * node.wavelength;
		ivec2 orders = ordersWithin(o, shift, 1.0);
		float width = BAND_DEVIATION * s * s * node.bandwidth;
		// The share of the first order's arc is a box of that length in the plane, 1/√12 of it its standard deviation.
		float arc = ARC_FILTER * p.frequency * node.bandwidth * unit;
		float arc2 = arc * arc / 12.0;
		#ifdef GRATING_SPREAD
		arc2 += node.wavelength * node.wavelength * spread2;
		#endif // GRATING_SPREAD
		float phase = reliefPhase(1.0, s);
		float efficiency = orderEfficiency(0, 2.0 * o.z * phase);
		float total = efficiency;
		#if defined(ENERGY_KIRCHHOFF) || defined(ENERGY_RECIPROCAL)
		efficiency *= energyFactor(vec3(-o.xy, o.z), o, s, width, p.frequency);
		#endif // ENERGY
		vec3 seen = efficiency * mirror;
		for (int k = orders.x; k < orders.y; k++) {
			int m = k < 0 ? k : k + 1;
			float order = float(m);
			float x = order * shift - o.x;
			float z2 = open - x * x;
			float z = sqrt(max(z2, 0.0));
			float w = o.z + z;
			efficiency = orderEfficiency(m, phase * w);
			total += efficiency;
			#if defined(ENERGY_KIRCHHOFF) || defined(ENERGY_RECIPROCAL)
			efficiency *= energyFactor(vec3(x, -o.y, z), o, s, width, p.frequency);
			#endif // ENERGY
			#ifdef BLURRED_LAYERS
			// Outwards and inwards at every other node, order and frame.
			float move = ((j ^ m ^ frame) & 1) == 0 ? w * uRoughness : -w * uRoughness;
			float spread = order * order * arc2 / max(z2, 0.0025);
			seen += efficiency * tiltedRadiance(across * x + along, up, 1.0 - z2, move, spread);
			#else
			float level = environmentLevel(order * order * arc2 / max(z2, 0.0025) + tilt2 * w * w);
			#ifndef ROUGH
			// Of a smooth surface whole levels: each is one read where others are two.
			level = floor(level);
			#endif // ROUGH
			seen += efficiency * environmentTexels(across * x + along + up * z, level);
			#endif // BLURRED_LAYERS
		}
		#if !defined(ENERGY_KIRCHHOFF) && !defined(ENERGY_RECIPROCAL)
		// The mean needs no floor as the light's lobes do: what is divided has the same factor.
		seen /= max(total, 1e-12);
		#endif // ENERGY
		xyz += node.tints * seen;
	}
	return xyz;
}
#endif // WAVELENGTH_LOOP

// Radiance (XYZ) towards wo from the environment. wo: unit, view space.
vec3 gratingRadianceFromEnvironment(SurfacePoint p, vec3 wo) {
	vec3 o = inFrame(p, wo);
	if (o.z <= 0.0) return vec3(0.0);
	#ifdef BLURRED_LAYERS
	vec3 plane = -o.x * inEnvironment(p.tangent) - o.y * inEnvironment(p.bitangent);
	vec3 up = inEnvironment(p.normal);
	float squared = 1.0 - o.z * o.z;
	float move = 2.0 * o.z * uRoughness;
	vec3 mirror = 0.5 * (
		tiltedRadiance(plane, up, squared, move, 0.0) + tiltedRadiance(plane, up, squared, -move, 0.0)
	);
	#else
	// A mip level read bilinearly blurs as a Gaussian of half its texel: footprint = 2 standard deviations.
	vec3 mirror = environmentRadiance(reflect(-wo, p.normal), 4.0 * o.z * uRoughness);
	#endif // BLURRED_LAYERS
	return arcsOfEnvironment(p, o, mirror);
}
#endif // ENVIRONMENT
