// A relief's lines at all wavelengths as a list of samples: radiance from the environment (docs/theory/height-fields.md). A
// sample is looked up once, where its middle sends the light, with a blur as wide as it.
// Needs environmentRadiance().

// A row a sample, the first is order 0: XYZ in light of the red, the green and the blue basis, each over w, then a texel of the
// middle λf (x, y) and the deviation along an axis.
uniform highp sampler2D uEnvironmentSamples;

// A rough surface's mirror image is the sharpest there is, and the brightest. It is read at four corners, each moved by this
// many standard deviations along x and y, and what is left of the deviation is a blur: √(1 − 0.7²).
#define MIRROR_CORNER 0.7
#define MIRROR_REST 0.714

// Neighbouring samples, boxes of 1/√12 of their width as deviation, are blurred by more than that: a small lamp would be
// seen as a row of blobs, 39 % brighter and darker than their mean. 1.3 times it leaves 12 %.
#define SAMPLE_BLUR 1.3

// XYZ of a sample in light of the three tints. w: cosθ_i + cosθ_o, 0 to 2.
mat3 sampleColors(int index, float w) {
	vec2 size = vec2(textureSize(uEnvironmentSamples, 0));
	vec2 uv = (0.5 + vec2(0.5 * w * float(ENVIRONMENT_W_STEPS - 1), index)) / size;
	vec2 next = vec2(float(ENVIRONMENT_W_STEPS) / size.x, 0.0);
	return mat3(
		textureLod(uEnvironmentSamples, uv, 0.0).xyz,
		textureLod(uEnvironmentSamples, uv + next, 0.0).xyz,
		textureLod(uEnvironmentSamples, uv + 2.0 * next, 0.0).xyz
	);
}

// Radiance (XYZ) towards wo from the environment. wo: unit, view space.
vec3 surfaceRadianceFromEnvironment(SurfacePoint p, vec3 wo) {
	vec3 o = inFrame(p, wo);
	if (o.z <= 0.0) return vec3(0.0);
	vec3 xyz = vec3(0.0);
	// Up to 0, k counts how often the mirror image is read.
	int samples = textureSize(uEnvironmentSamples, 0).y;
	for (int k = 1 - MIRROR_LOOKUPS; k < ENVIRONMENT_SAMPLES; k++) {
		if (k >= samples) break;  // a relief of few lines has fewer
		vec3 place = texelFetch(uEnvironmentSamples, ivec2(3 * ENVIRONMENT_W_STEPS, max(k, 0)), 0).xyz;
		vec2 xy = place.xy - o.xy;
		float blur = place.z;
		// cos²θ_i of the sample's light, taken as even over its middle ± √3 deviations. Of what is above the horizon, cosθ_i is
		// from low to high. 1/cosθ_i has no bound there, but a mean: 2/(low + high).
		float r2 = dot(xy, xy);
		float reach = max(3.4641016 * sqrt(r2) * blur, 1e-6);
		float above = clamp(0.5 + 0.5 * (1.0 - r2) / reach, 0.0, 1.0);
		if (above <= 0.0) continue;
		float high = sqrt(max(1.0 - r2 + reach, 0.0));
		float low = sqrt(max(1.0 - r2 - reach, 0.0));
		vec3 i = normalize(vec3(xy, 0.5 * (low + high)));
		float w = o.z + i.z;
		float tilt = w * uRoughness;
		float share = above;
		vec3 towards = i;
		#if MIRROR_LOOKUPS > 1
		if (k <= 0) {
			vec2 corner = 2.0 * vec2(k & 1, (k >> 1) & 1) - 1.0;
			vec2 moved = i.xy + MIRROR_CORNER * tilt * corner;
			moved /= max(length(moved), 1.0);
			towards = vec3(moved, sqrt(max(1.0 - dot(moved, moved), 0.0)));
			tilt *= MIRROR_REST;
			share /= float(MIRROR_LOOKUPS);
		}
		#endif // MIRROR_LOOKUPS
		// What lies in the plane is longer by 1/cosθ_i in directions, but for one of the two axes; of the two variances the
		// mean. A mip level read bilinearly blurs as a Gaussian of half its texel: footprint = 2 standard deviations.
		float cosine = max(i.z, 0.05);
		float across = SAMPLE_BLUR * blur;
		float along = above * across / cosine;
		float variance = 0.5 * (along * along + across * across + tilt * tilt * (1.0 + 1.0 / (cosine * cosine)));
		vec3 direction = p.tangent * towards.x + p.bitangent * towards.y + p.normal * towards.z;
		vec3 radiance = environmentRadiance(direction, 2.0 * sqrt(variance));
		xyz += sampleColors(max(k, 0), w) * radiance * (share * kirchhoffFactor(i, o) * reflectance(i, o));
	}
	return xyz;
}
