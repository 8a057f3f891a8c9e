// Diffraction by a grating: radiance from one light and from the environment (docs/theory.md, sections 4 and 6).
// Needs a SurfacePoint and LightSpectrum, and environmentRadiance() where ENVIRONMENT is defined.
#include "spectrum.glsl"
#include "propagation.glsl"

uniform float uWindowVariance;  // 1/(8π²σ²), variance of the coherence window's lobe in spatial frequency, 1/µm²
uniform float uRoughness;       // standard deviation of the normal's tilt, rad
uniform highp sampler2D uLightNodes;
#ifdef ENVIRONMENT
uniform highp sampler2D uEnvironmentNodes;
#endif // ENVIRONMENT

// exp(−14) = 8e-7: a lobe is left out where it has fallen below that share of its peak.
#define EXPONENT_CUT 14.0

// Covariance of a lobe in the plane of (u, v) beyond that of the coherence window (xx, yy, xy).
// Normals tilted by ε move (u, v) by wε; a light's disc projects onto the surface. wi: grating frame.
vec3 lobeBlur(vec3 wi, float w, float angularRadius) {
	float tilt = w * uRoughness;
	float source = angularRadius * angularRadius;
	return vec3(
		tilt * tilt + source * (1.0 - wi.x * wi.x),
		tilt * tilt + source * (1.0 - wi.y * wi.y),
		-source * wi.x * wi.y
	);
}

// Σ over spectral nodes and over orders first to last of S e_m N(s(u, v) − (m/a, 0); C), XYZ in 1/sr: the direct sum,
// for lobes wide enough that neighbouring nodes overlap.
vec3 lobesByNodes(
	highp sampler2D nodes, int count, vec3 wi, vec3 wo, vec3 blur, float frequency, ivec2 orders, vec3 tint
) {
	vec3 uvw = wi + wo;
	vec3 xyz = vec3(0.0);
	for (int i = 0; i < count; i++) {
		SpectralNode node = spectralNode(nodes, i);
		float s = 1.0 / node.wavelength;
		vec3 c = vec3(uWindowVariance, uWindowVariance, 0.0) + s * s * blur;
		float determinant = c.x * c.y - c.z * c.z;
		float phase = reliefPhase(uvw.z, s);
		float sum = 0.0;
		for (int m = orders.x; m <= orders.y; m++) {
			vec2 f = s * uvw.xy - vec2(float(m) * frequency, 0.0);
			float exponent = (c.y * f.x * f.x - 2.0 * c.z * f.x * f.y + c.x * f.y * f.y) / (2.0 * determinant);
			if (exponent < EXPONENT_CUT) sum += exp(-exponent) * orderEfficiency(m, phase);
		}
		if (sum > 0.0) {
			// dλ of the band times s² N = N ds.
			float density = s * s * sum / (2.0 * PI * sqrt(determinant));
			// A band of width B is a box: B/√12 its standard deviation, s² its scale in wavenumber.
			float factor = energyFactor(wi, wo, s, 0.289 * s * s * node.bandwidth, frequency);
			xyz += node.tints * tint * (node.reflectance * density * factor);
		}
	}
	return xyz;
}

#ifndef WAVELENGTH_LOOP
// The orders whose lobes are narrow in wavenumber, each in closed form: with d = (u, v), g = (m/a, 0) and C the lobe's
// covariance in spatial frequency, the exponent −½ (s d − g)ᵀ C⁻¹ (s d − g) is a Gaussian in s about
// s* = dᵀC⁻¹g/dᵀC⁻¹d with variance q² = 1/dᵀC⁻¹d, times exp(−½ (g × d)²/(det C · dᵀC⁻¹d)). XYZ in 1/sr.
vec3 lobesInClosedForm(vec3 wi, vec3 wo, vec3 blur, float frequency, ivec2 orders, vec3 tint) {
	vec3 uvw = wi + wo;
	float u = uvw.x, v = uvw.y;
	vec3 xyz = vec3(0.0);
	for (int m = orders.x; m <= orders.y; m++) {
		if (m == 0) continue;  // s* = 0: where order 0 is in reach, lobes are wide
		float g = float(m) * frequency;
		// C depends on s through the blur; it is taken where the sharp lobe would have its middle.
		float s = clamp(g * u / (u * u + v * v), WAVENUMBER_MIN, WAVENUMBER_MAX);
		vec3 c = vec3(uWindowVariance, uWindowVariance, 0.0) + s * s * blur;
		float determinant = c.x * c.y - c.z * c.z;
		float adjugate = c.y * u * u - 2.0 * c.z * u * v + c.x * v * v;  // dᵀ C⁻¹ d · det C
		float exponent = 0.5 * g * g * v * v / adjugate;
		if (exponent > EXPONENT_CUT) continue;
		float width = sqrt(determinant / adjugate);
		float middle = g * (c.y * u - c.z * v) / adjugate;
		vec4 color = lobeColor(middle, width, tint);
		float mean = color.w;
		// √(2π) q / (2π √det C): the Gaussian in s is normalised in the table.
		float density = width * exp(-exponent) / sqrt(2.0 * PI * determinant);
		float efficiency = orderEfficiency(m, reliefPhase(uvw.z, mean)) * energyFactor(wi, wo, mean, width, frequency);
		xyz += color.xyz * (metalReflectance(mean) * density * efficiency);
	}
	return xyz;
}
#endif // WAVELENGTH_LOOP

// Components of a direction in the grating's frame.
vec3 inFrame(SurfacePoint p, vec3 direction) {
	return vec3(dot(direction, p.tangent), dot(direction, p.bitangent), dot(direction, p.normal));
}

// Radiance (XYZ) towards wo from one light: f_r cosθ_i times its irradiance. Zero below the horizon. wi, wo: unit, view
// space.
vec3 surfaceRadianceFromLight(SurfacePoint p, vec3 wi, vec3 wo, LightSpectrum light) {
	vec3 i = inFrame(p, wi);
	vec3 o = inFrame(p, wo);
	if (i.z <= 0.0 || o.z <= 0.0 || p.frequency <= 0.0) return vec3(0.0);
	vec3 uvw = i + o;
	vec3 blur = lobeBlur(i, uvw.z, light.angularRadius);
	#ifdef WAVELENGTH_LOOP
	ivec2 orders = ivec2(-MAX_ORDER, MAX_ORDER);
	return i.z * lobesByNodes(uLightNodes, LIGHT_NODES, i, o, blur, p.frequency, orders, light.color);
	#else
	// A pixel far from the line v = 0 sees no order at any visible wavelength: the lobe is widest at the longest one.
	float sLow = WAVENUMBER_MIN, sHigh = WAVENUMBER_MAX;
	float varianceV = uWindowVariance / (sLow * sLow) + blur.y;
	if (uvw.y * uvw.y > 2.0 * EXPONENT_CUT * varianceV) return vec3(0.0);
	// Widest standard deviation of a lobe in spatial frequency, and of its Gaussian in wavenumber.
	float spread = sqrt(uWindowVariance + sHigh * sHigh * (max(blur.x, blur.y) + abs(blur.z)));
	float rho = length(uvw.xy);
	bool wide = spread > LOBE_WIDTH_MAX * rho;
	// Orders m/a in reach, for u ≥ 0. Wide: s·u within the exponent's cut, √28 = 5.3 standard deviations, for some visible
	// s. Narrow: the lobe's middle (m/a) u/ρ² within its table's margin of the visible range.
	float stretch = wide ? abs(uvw.x) : rho * rho / max(abs(uvw.x), 1e-6);
	float slack = wide ? 5.3 * spread : LOBE_MARGIN * spread * stretch / rho;
	vec2 range = vec2(sLow * stretch - slack, sHigh * stretch + slack) / p.frequency;
	if (uvw.x < 0.0) range = -range.yx;
	range = clamp(range, -float(MAX_ORDER), float(MAX_ORDER));
	ivec2 orders = ivec2(ceil(range.x), floor(range.y));
	if (orders.x > orders.y) return vec3(0.0);
	return i.z * (
		wide
			? lobesByNodes(uLightNodes, LIGHT_NODES, i, o, blur, p.frequency, orders, light.color)
			: lobesInClosedForm(i, o, blur, p.frequency, orders, light.color)
	);
	#endif // WAVELENGTH_LOOP
}

#ifdef ENVIRONMENT
// Radiance (XYZ) towards wo from the environment: for each spectral node the mean of what the propagating orders see,
// weighted by their efficiencies. wo: unit, view space.
vec3 surfaceRadianceFromEnvironment(SurfacePoint p, vec3 wo) {
	vec3 o = inFrame(p, wo);
	if (o.z <= 0.0) return vec3(0.0);
	// A mip level read bilinearly blurs as a Gaussian of half its texel: footprint = 2 standard deviations.
	vec3 mirror = environmentRadiance(reflect(-wo, p.normal), 4.0 * o.z * uRoughness);
	vec3 xyz = vec3(0.0);
	for (int j = 0; j < ENVIRONMENT_NODES; j++) {
		SpectralNode node = spectralNode(uEnvironmentNodes, j);
		float s = 1.0 / node.wavelength;
		float shift = p.frequency * node.wavelength;
		ivec2 orders = propagatingOrders(o, shift);
		float width = 0.289 * s * s * node.bandwidth;
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
				// The band's share of the arc is a box of that length, 1/√12 of it its standard deviation.
				float arc = ARC_FILTER * abs(float(m)) * p.frequency * node.bandwidth / max(z, 0.05);
				float tilt = (o.z + z) * uRoughness;
				float footprint = 2.0 * sqrt(arc * arc / 12.0 + tilt * tilt);
				radiance = environmentRadiance(p.tangent * i.x + p.bitangent * i.y + p.normal * i.z, footprint);
			}
			seen += efficiency * radiance;
		}
		#if !defined(ENERGY_KIRCHHOFF) && !defined(ENERGY_RECIPROCAL)
		seen /= max(total, 1e-4);
		#endif // ENERGY
		xyz += node.reflectance * (node.tints * seen);
	}
	return xyz;
}
#endif // ENVIRONMENT
