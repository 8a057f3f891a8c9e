// A clear lacquer over the surface: dielectric, thin, without absorption.
#include "fresnel.glsl"

#ifdef COAT

uniform float uCoat;           // share of the surface it covers, 0 to 1
uniform float uCoatIor;        // refractive index, above 1
uniform float uCoatRoughness;  // three's roughness: its square is the slope parameter alpha of GGX

// Share of light that passes the lacquer once, in or out; what is not covered passes whole.
float coatTransmittance(float cosTheta) {
	return 1.0 - uCoat * fresnelDielectric(clamp(cosTheta, 0.0, 1.0), uCoatIor);
}

// Radiance (linear sRGB) that the lacquer throws from one light to the viewer. wi, wo, normal: unit vectors.
// A rough lacquer has the lobe of GGX with the height-correlated Smith term (Heitz 2014). A smooth one shows the light itself:
// of a Gaussian light of deviation r, F E exp(−|d|²/2r²)/(2π r²) with d from the light to the mirrored view. Where both spread
// it, half vectors by alpha/√2 and r/2 along an axis, the highlight is of both shapes, by their shares of the variance
// (docs/theory/lacquer.md). Below alpha = 0.0025 a highlight is smaller than a pixel and its peak, 1/(π alpha²), nears the
// largest half float, 65504.
vec3 coatRadianceFromLight(vec3 normal, vec3 wi, vec3 wo, LightSpectrum light) {
	float cosI = dot(normal, wi);
	float cosO = dot(normal, wo);
	if (cosI <= 0.0 || cosO <= 0.0) return vec3(0.0);
	vec3 h = normalize(wi + wo);
	float alpha = uCoatRoughness * uCoatRoughness;
	float disc2 = light.angularRadius * light.angularRadius;
	float a2 = max(alpha * alpha + 0.5 * disc2, 6.25e-6);
	// 1 − cos²(1 − a²) = a² + sin²(1 − a²), with sin² from a cross product: the difference of two numbers near 1
	// would cost a sharp highlight its digits.
	vec3 nxh = cross(normal, h);
	float denominator = a2 + (1.0 - a2) * dot(nxh, nxh);
	float smithI = cosO * sqrt(a2 + (1.0 - a2) * cosI * cosI);
	float smithO = cosI * sqrt(a2 + (1.0 - a2) * cosO * cosO);
	float lobe = fresnelDielectric(dot(wi, h), uCoatIor) * a2 * cosI / (2.0 * PI * denominator * denominator * (smithI + smithO));
	vec3 off = reflect(-wo, normal) - wi;
	float image = fresnelDielectric(cosO, uCoatIor) * exp(-0.25 * dot(off, off) / a2) / (4.0 * PI * a2);
	return light.color * (uCoat * mix(lobe, image, 0.5 * disc2 / a2));
}

#ifdef ENVIRONMENT
// Radiance (linear sRGB) of the environment in the lacquer: one look in the mirror direction, blurred over the lobe's
// full width at half maximum. GGX halves at tanθh = 0.64 alpha, a reflection turns by twice that, to both sides: 2.57 alpha.
vec3 coatRadianceFromEnvironment(vec3 normal, vec3 wo) {
	float cosO = clamp(dot(normal, wo), 0.0, 1.0);
	float footprint = 2.57 * uCoatRoughness * uCoatRoughness;
	return uCoat * fresnelDielectric(cosO, uCoatIor) * environmentRadiance(reflect(-wo, normal), footprint);
}
#endif // ENVIRONMENT

#endif // COAT
