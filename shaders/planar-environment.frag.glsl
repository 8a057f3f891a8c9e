// Fills one layer of the table of planar-environment.glsl: what one grating in one plane shows of the environment in each
// direction. Drawn with a camera that is not turned, so that view space is the world.
#include <common>

#include "surface-point.glsl"
#include "environment.glsl"
#include "grating.glsl"
#include "planar-environment.glsl"

uniform mat3 uPlane;               // tangent, bitangent, normal of the mesh: orthonormal columns, world
uniform vec3 uGrating;             // cos θ, sin θ, frequency in 1/µm
uniform vec3 uTilts[PLANAR_TILTS]; // tilt of the normal along x and y, and its weight

// The frame of the grating on a facet whose normal is tilted by slopes along its x and y axes.
SurfacePoint tilted(mat3 frame, vec2 slope) {
	vec3 normal = normalize(frame[2] + slope.x * frame[0] + slope.y * frame[1]);
	vec3 tangent = normalize(frame[0] - dot(frame[0], normal) * normal);
	// Not a cross product: mirrored uv make left-handed frames.
	vec3 bitangent = frame[1] - dot(frame[1], normal) * normal;
	bitangent = normalize(bitangent - dot(bitangent, tangent) * tangent);
	return SurfacePoint(tangent, bitangent, normal, uGrating.z, 1.0);
}

void main() {
	mat3 frame = mat3(
		uGrating.x * uPlane[0] + uGrating.y * uPlane[1],
		uGrating.x * uPlane[1] - uGrating.y * uPlane[0],
		uPlane[2]
	);
	vec3 o = hemisphereFromSquare(gl_FragCoord.xy / PLANAR_TEXELS);
	// At the rim itself nothing is seen; what is filtered there is seen a little above it.
	o = normalize(vec3(o.xy, max(o.z, 0.5 / PLANAR_TEXELS)));
	vec3 wo = frame * o;
	// A rough surface is the mean of facets. The environment's own blur, which is that of a mip level, is left with the
	// small rest of the roughness; facets that face away from the viewer count for none.
	vec4 sum = vec4(0.0);
	for (int i = 0; i < PLANAR_TILTS; i++) {
		SurfacePoint facet = tilted(frame, uTilts[i].xy);
		if (dot(facet.normal, wo) > 0.0) sum += uTilts[i].z * vec4(gratingRadianceFromEnvironment(facet, wo), 1.0);
	}
	// The largest half float: a sun may be brighter.
	gl_FragColor = vec4(min(sum.xyz / max(sum.w, 1e-6), 65504.0), 1.0);
}
