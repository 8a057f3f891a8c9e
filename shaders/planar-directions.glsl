// Directions above a surface in the texels of a square, for tables over the view (planar-environment.glsl). The hemisphere is
// folded out: an octahedron's upper half, turned by an eighth (Cigolle et al. 2014, "A survey of efficient representations
// for independent unit vectors"). Its rim lies on the middles of the outermost texels, so that bilinear filtering never
// leaves it.

// Direction (unit, z ≥ 0) → place in the square, 0 to 1. texels: along a side.
vec2 squareFromHemisphere(vec3 direction, float texels) {
	vec2 p = direction.xy / (abs(direction.x) + abs(direction.y) + direction.z);
	return 0.5 + (0.5 - 0.5 / texels) * vec2(p.x + p.y, p.x - p.y);
}

// Its inverse. square: 0 to 1; texels: along a side.
vec3 hemisphereFromSquare(vec2 square, float texels) {
	vec2 turned = (square - 0.5) / (0.5 - 0.5 / texels);
	vec2 p = 0.5 * vec2(turned.x + turned.y, turned.x - turned.y);
	return normalize(vec3(p, max(1.0 - abs(p.x) - abs(p.y), 0.0)));
}
