// The frame in which a surface states its orientation: tangent along growing u, bitangent on the side of growing v.
// Needs vViewPosition, vUv and, with USE_TANGENT, vTangent and vHandedness; a layer has no vertex stage to bring them.
#if defined(USE_TANGENT) && !defined(LAYER)
#define STATED_TANGENT
varying float vHandedness;
#endif // STATED_TANGENT

// Any unit vector at right angles to the unit vector n, without a branch that two neighbouring pixels take
// differently in the hemisphere that faces the viewer: there n.z > 0.
// Source: Duff et al. 2017, "Building an orthonormal basis, revisited".
vec3 anyPerpendicular(vec3 n) {
	float s = n.z >= 0.0 ? 1.0 : -1.0;
	float a = -1.0 / (s + n.z);
	return vec3(1.0 + s * n.x * n.x * a, s * n.x * n.y * a, -s * n.x);
}

// Orthonormal frame (tangent, bitangent, normal) in view space for a unit shading normal that faces the viewer.
// faceDirection: 1 on front faces, −1 on back faces.
//
// Both routes follow the direction in which u grows, ∂P/∂u, projected into the plane of the normal, and take for the
// bitangent that one of the two perpendiculars on whose side v grows; so mirrored uv give a left-handed frame.
// Uv that do not vary, or vary along one direction only, have no such direction: any frame serves then.
//
// Back faces turn tangent and bitangent round. Seen from behind, a relief h(x) is −h(x); with x' = −x it is
// p'(ξ) = 1 − p(−ξ), whose Fourier coefficients are the conjugates of p's but for a phase: the same order
// efficiencies, so the table of the front holds for the back, blazed profiles included.
mat3 surfaceFrame(vec3 normal, float faceDirection) {
	#ifdef STATED_TANGENT
	vec3 alongU = vTangent;
	float handedness = vHandedness;
	#else
	vec3 dPdx = dFdx(-vViewPosition);
	vec3 dPdy = dFdy(-vViewPosition);
	vec2 dUVdx = dFdx(vUv);
	vec2 dUVdy = dFdy(vUv);
	// The pixel grid is right-handed about a normal that faces the viewer, so the determinant's sign is the
	// handedness of the uv; the determinant itself, tiny at a distance, is never divided by.
	float handedness = sign(dUVdx.x * dUVdy.y - dUVdy.x * dUVdx.y);
	vec3 alongU = handedness * (dPdx * dUVdy.y - dPdy * dUVdx.y);
	#endif // STATED_TANGENT

	vec3 tangent = alongU - dot(alongU, normal) * normal;
	float length2 = dot(tangent, tangent);
	// Not "> 0": a NaN must fail it too. 1e-30 is far above float32's smallest normal number and far below the
	// square of any direction that means something (a metre on a pixel of a nanometre).
	bool defined = length2 > 1e-30 && handedness != 0.0;
	tangent = defined ? tangent * inversesqrt(length2) : anyPerpendicular(normal);
	vec3 bitangent = cross(normal, tangent) * (defined ? sign(handedness) : 1.0);

	#if defined(DOUBLE_SIDED)
	tangent *= faceDirection;
	bitangent *= faceDirection;
	#ifdef STATED_TANGENT
	// The handedness was stated for the outward normal, which the back face has turned round.
	bitangent *= faceDirection;
	#endif // STATED_TANGENT
	#elif defined(FLIP_SIDED)
	tangent = -tangent;
	bitangent = -bitangent;
	#ifdef STATED_TANGENT
	bitangent = -bitangent;
	#endif // STATED_TANGENT
	#endif // DOUBLE_SIDED, FLIP_SIDED

	return mat3(tangent, bitangent, normal);
}
