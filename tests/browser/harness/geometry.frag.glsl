// What the material's fragment stage starts from, pixel by pixel: for a reference that must see the same geometry.
layout(location = 0) out highp vec4 outPosition;   // view space; w: 1 where the surface is
layout(location = 1) out highp vec4 outNormal;     // view space, towards the viewer; w: strength
layout(location = 2) out highp vec4 outTangent;    // frame's tangent, view space; w: frequency, 1/µm
layout(location = 3) out highp vec4 outGrating;    // grating vector's direction, view space
layout(location = 4) out highp vec4 outUv;

varying vec3 vViewPosition;

#include <common>
#include <uv_pars_fragment>
#include <normal_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <clipping_planes_pars_fragment>

#include "tangent-frame.glsl"
#include "surface.glsl"

void main() {
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	mat3 frame = surfaceFrame(normal, faceDirection);
	SurfacePoint point = surfacePointAt(frame[0], frame[1], frame[2], vUv);
	outPosition = vec4(-vViewPosition, 1.0);
	outNormal = vec4(point.normal, point.strength);
	outTangent = vec4(frame[0], point.frequency);
	outGrating = vec4(point.tangent, 0.0);
	outUv = vec4(vUv, 0.0, 0.0);
}
