// A map of gratings: orientation, frequency and strength at every texel.
#include "surface-point.glsl"

uniform sampler2D uFoilMap;    // cos 2θ, sin 2θ, frequency, strength, as stored
uniform vec4 uFoilOffset;      // value = offset + scale · texel; frequency in 1/µm
uniform vec4 uFoilScale;
uniform vec2 uFoilRepeat;      // tiles along u and v

// tangent, bitangent, normal: orthonormal, view space, tangent towards growing u; uv: texture coordinates, 1.
SurfacePoint surfacePointAt(vec3 tangent, vec3 bitangent, vec3 normal, vec2 uv) {
	vec4 texel = uFoilOffset + uFoilScale * textureLod(uFoilMap, uv * uFoilRepeat, 0.0);
	// Eight-bit steps leave (cos 2θ, sin 2θ) a little off the unit circle; texels without a grating hold zero.
	float length2 = dot(texel.xy, texel.xy);
	vec2 doubled = length2 > 0.0 ? texel.xy * inversesqrt(length2) : vec2(1.0, 0.0);
	// Half the angle, θ from −π/2 to π/2: orientation is known modulo π.
	float c = sqrt(max(0.5 + 0.5 * doubled.x, 0.0));
	float s = sqrt(max(0.5 - 0.5 * doubled.x, 0.0)) * (doubled.y < 0.0 ? -1.0 : 1.0);
	return SurfacePoint(
		c * tangent + s * bitangent,
		c * bitangent - s * tangent,
		normal, max(texel.z, 0.0), clamp(texel.w, 0.0, 1.0)
	);
}

#ifdef DIFFRACTION
#include "grating.glsl"
#endif // DIFFRACTION
