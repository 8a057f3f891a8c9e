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
// GGX with the height-correlated Smith term (Heitz 2014). A Gaussian light of deviation r spreads half vectors by r/2, as a
// Gaussian: a smooth lacquer shows the light itself, F E/(2π r²) in its middle, a rough one its own lobe, and between them the
// highlight is of both shapes by their shares of the width. Below alpha = 0.0025 a highlight is smaller than a pixel and its
// peak, 1/(π alpha²), nears the largest half float, 65504.
vec3 coatRadianceFromLight(vec3 normal, vec3 wi, vec3 wo, LightSpectrum light) {
	float cosI = dot(normal, wi);
	float cosO = dot(normal, wo);
	if (cosI <= 0.0 || cosO <= 0.0) return vec3(0.0);
	vec3 h = normalize(wi + wo);
	float cosH = clamp(dot(normal, h), 0.0, 1.0);
	float alpha2 = uCoatRoughness * uCoatRoughness * uCoatRoughness * uCoatRoughness;
	float disc2 = 0.5 * light.angularRadius * light.angularRadius;
	float a2 = max(alpha2 + disc2, 6.25e-6);
	// 1 − cos²(1 − a²) = sin² + a² cos², with sin² from a cross product: the difference of two numbers near 1
	// would cost a sharp highlight its digits.
	vec3 nxh = cross(normal, h);
	float sin2 = dot(nxh, nxh), cos2 = max(cosH * cosH, 1e-6);
	float spread = sin2 + a2 * cos2;
	float ggx = a2 / (spread * spread);
	float gaussian = exp(-sin2 / (a2 * cos2)) / (a2 * cos2 * cos2);
	float distribution = mix(ggx, gaussian, disc2 / a2) / PI;
	float smithI = cosO * sqrt(alpha2 + (1.0 - alpha2) * cosI * cosI);
	float smithO = cosI * sqrt(alpha2 + (1.0 - alpha2) * cosO * cosO);
	float visibility = 0.5 / (smithI + smithO);
	float fresnel = fresnelDielectric(clamp(dot(wi, h), 0.0, 1.0), uCoatIor);
	return light.color * (uCoat * fresnel * distribution * visibility * cosI);
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
