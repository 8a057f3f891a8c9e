// Vertex stage: three's own chunks in three's own order, and the sign that completes the tangent frame.

varying vec3 vViewPosition;
#ifdef USE_TANGENT
varying float vHandedness;
#endif // USE_TANGENT

#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>

void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>

	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>

	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>

	vViewPosition = -mvPosition.xyz;

	#ifdef USE_TANGENT
	// cross(normal, tangent) · w is the direction of growing v where it was computed, in the object. A mirroring
	// transform turns a cross product round, so the sign of its determinant goes with w.
	mat3 handednessMatrix = mat3(modelViewMatrix);
	#ifdef USE_INSTANCING
	handednessMatrix = handednessMatrix * mat3(instanceMatrix);
	#endif // USE_INSTANCING
	#ifdef USE_BATCHING
	handednessMatrix = handednessMatrix * mat3(batchingMatrix);
	#endif // USE_BATCHING
	vHandedness = tangent.w * sign(determinant(handednessMatrix));
	#endif // USE_TANGENT

	#include <worldpos_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}
