// Reflectance of a smooth dielectric for unpolarised light, the exact Fresnel equations.
// cosTheta: cosine of the angle to the normal outside, 0 to 1; ior: index inside over outside, above 1.
float fresnelDielectric(float cosTheta, float ior) {
	// Snell: ior² cos²θt = ior² − sin²θi, above zero for ior > 1.
	float iorCosT = sqrt(ior * ior - 1.0 + cosTheta * cosTheta);
	float s = (cosTheta - iorCosT) / (cosTheta + iorCosT);
	float ior2CosI = ior * ior * cosTheta;
	float p = (ior2CosI - iorCosT) / (ior2CosI + iorCosT);
	return 0.5 * (s * s + p * p);
}
