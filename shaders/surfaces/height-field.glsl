// A height field that repeats over the whole surface.
#include "surface-point.glsl"

uniform vec2 uReliefDirection;   // (cos, sin) of the angle from growing u to the patch's x axis
uniform float uReliefStrength;   // share of the surface that diffracts, 0 to 1

// tangent, bitangent, normal: orthonormal, view space, tangent towards growing u; uv: texture coordinates, 1.
SurfacePoint surfacePointAt(vec3 tangent, vec3 bitangent, vec3 normal, vec2 uv) {
	return SurfacePoint(
		uReliefDirection.x * tangent + uReliefDirection.y * bitangent,
		uReliefDirection.x * bitangent - uReliefDirection.y * tangent,
		normal, 0.0, uReliefStrength, vec2(0.0)
	);
}

#ifdef DIFFRACTION
#include "height-field.glsl"
#endif // DIFFRACTION
