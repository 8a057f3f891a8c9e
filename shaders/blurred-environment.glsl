// The environment as tilts of a rough surface blur it: layers of Gaussians, each of twice the variance of the one before,
// the first without any. A box that a mip level is would show a lamp as a square, wider or narrower than it should be.
// Needs equirectAt() of environment.glsl.
#ifdef BLURRED_LAYERS

uniform highp sampler3D uBlurredLayers;  // equirectangular, linear sRGB over BLURRED_RADIANCE, the first without blur
uniform float uBlurUnit;                 // 1 over the second layer's variance, 1/rad²

// Radiance of 1 in the layers, which are half floats: suns are brighter than 65504.
#define BLURRED_RADIANCE 16.0

// Radiance (linear sRGB) from a unit direction of the texture's own, blurred by a Gaussian of that variance (rad²) along each
// axis. Between layers their mean of that variance: a float's own bits are straight between powers of two.
vec3 blurredRadiance(vec3 direction, float variance) {
	float x = variance * uBlurUnit;
	float bits = float(floatBitsToInt(x));
	float layer = x < 1.0 ? x : bits / 8388608.0 - 126.0;  // 23 bits of fraction; an exponent of 127 is 1
	vec3 place = vec3(equirectAt(direction), (0.5 + layer) / float(BLURRED_LAYERS));
	return textureLod(uBlurredLayers, place, 0.0).rgb * (BLURRED_RADIANCE * uEnvironmentIntensity);
}

#endif // BLURRED_LAYERS
