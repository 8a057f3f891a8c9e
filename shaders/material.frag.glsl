// Fragment stage: a diffracting surface over a matt base, under a lacquer.

uniform vec3 uBaseColor;    // colour of the matt base, linear sRGB
uniform float uOpacity;

varying vec3 vViewPosition;

#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <fog_pars_fragment>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>

#include "tangent-frame.glsl"
#include "surface-point.glsl"
#include "environment.glsl"
#include "coat.glsl"
#include "gamut.glsl"
#include "surface.glsl"
#include "lights.glsl"

void main() {
	vec4 diffuseColor = vec4(uBaseColor, uOpacity);
	#include <clipping_planes_fragment>
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>

	mat3 frame = surfaceFrame(normal, faceDirection);
	LitSurface material;
	material.point = surfacePointAt(frame[0], frame[1], frame[2], vUv);
	material.baseColor = diffuseColor.rgb;
	material.coatNormal = nonPerturbedNormal;

	ReflectedLight reflectedLight;  // three's loop passes it on; the sums are kept in lights.glsl
	#include <lights_fragment_begin>
	#include <lights_fragment_end>

	vec3 outgoingLight = coatRgb;
	#ifdef DIFFRACTION
	outgoingLight += material.point.strength * (uXyzToRgb * diffractedXyz);
	#endif // DIFFRACTION
	#ifdef BASE
	outgoingLight += (1.0 - material.point.strength) * baseRgb;
	#endif // BASE
	#ifdef GAMUT_MAPPED
	outgoingLight = gamutMapped(outgoingLight);
	#endif // GAMUT_MAPPED

	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}
