// Stam's obliquity factor (1999): (1 + ω_i·ω_o)²/(cosθ_i cosθ_o w²). Grows without bound at grazing angles, hence the
// floor: 1e-6 is far below the cosine of any pixel that is not edge-on. wi, wo: unit, in the surface's frame.
float kirchhoffFactor(vec3 wi, vec3 wo) {
	float w = wi.z + wo.z;
	float g = 1.0 + dot(wi, wo);
	return g * g / max(wi.z * wo.z * w * w, 1e-6);
}
