// A foil of few gratings: a pixel that covers many texels shows the mean of their radiance, Σ share · radiance over the
// foil's gratings, FOIL_GRATINGS of them.

// Orientations have no mean, but shares do: what share of a pixel each grating of the foil covers, strength included, is
// a mean over texels that mip levels hold and texture units filter. Four gratings to a layer. mediump: devices may cut what
// is read to a half float, 5e-4 of a whole share at most, an eighth of the 8-bit steps in which shares are stored.
uniform mediump sampler2DArray uFoilShares;
uniform vec3 uFoilGratings[FOIL_GRATINGS];  // cos θ, sin θ, frequency in 1/µm

// Less than half an 8-bit step of a share is none.
#define SMALLEST_SHARE 0.001

// A texture unit weighs texels by a tent wider than what it is asked for. A pixel that covers more than a texel is read by
// a grid of taps along its sides, each asking for this share of its cell, whose sum comes close to a box. The wider the
// pixel, the more taps it takes for the same error: 4 along each side of 4 texels, 8 of 64 and more.
#define FOIL_TAP_WIDTH 0.7
#define FOIL_MOST_TAPS 8.0

struct FoilFootprint {
	float taps;    // along each side of the pixel
	float level;   // mip level of a tap
	vec2 uv;       // of its middle, in tiles
	vec2 alongX;   // change of uv over the pixel
	vec2 alongY;
	uint present;  // a bit for each grating that has a share
};
FoilFootprint foilFootprint;

// The mesh's frame, from which each grating's own follows, and the share of the pixel that diffracts.
SurfacePoint foilPointAt(vec3 tangent, vec3 bitangent, vec3 normal, vec2 uv) {
	foilFootprint = FoilFootprint(1.0, 0.0, uv * uFoilRepeat, dFdx(uv) * uFoilRepeat, dFdy(uv) * uFoilRepeat, 0u);
	vec2 texels = vec2(textureSize(uFoilShares, 0));
	vec2 x = foilFootprint.alongX * texels, y = foilFootprint.alongY * texels;
	float width2 = max(dot(x, x), dot(y, y));
	if (width2 <= 1.0) {
		// A texel is as wide as a pixel: there is nothing to average. Its middle has no share of its neighbours.
		vec2 middle = (floor(foilFootprint.uv * texels) + 0.5) / texels;
		foilFootprint = FoilFootprint(1.0, 0.0, middle, vec2(0.0), vec2(0.0), 0u);
	} else {
		float width = sqrt(width2);
		foilFootprint.taps = min(ceil(2.0 + log2(width)), FOIL_MOST_TAPS);
		foilFootprint.level = max(log2(FOIL_TAP_WIDTH * width / foilFootprint.taps), 0.0);
	}
	float strength = 0.0;
	float wholeLevel = max(0.5 * log2(width2), 0.0);
	for (int layer = 0; 4 * layer < FOIL_GRATINGS; layer++) {
		vec4 shares = textureLod(uFoilShares, vec3(foilFootprint.uv, layer), wholeLevel);
		strength += shares.x + shares.y + shares.z + shares.w;
		uvec4 bits = uvec4(greaterThan(shares, vec4(SMALLEST_SHARE))) * uvec4(1u, 2u, 4u, 8u);
		foilFootprint.present |= (bits.x + bits.y + bits.z + bits.w) << (4 * layer);
	}
	return SurfacePoint(tangent, bitangent, normal, 0.0, min(strength, 1.0), vec2(0.0));
}

// Shares of a layer's four gratings in the pixel, the mean over a grid of taps.
vec4 foilShares(int layer) {
	float taps = foilFootprint.taps;
	vec2 cellX = foilFootprint.alongX / taps, cellY = foilFootprint.alongY / taps;
	vec4 shares = vec4(0.0);
	for (float i = 0.0; i < taps; i++)
		for (float j = 0.0; j < taps; j++) {
			vec2 at = vec2(i, j) - 0.5 * (taps - 1.0);
			vec3 place = vec3(foilFootprint.uv + at.x * cellX + at.y * cellY, layer);
			shares += textureLod(uFoilShares, place, foilFootprint.level);
		}
	return shares / (taps * taps);
}

// A grating of the foil in the mesh's frame. strength: its share of what diffracts in the pixel.
SurfacePoint foilGrating(SurfacePoint p, int number, float strength) {
	vec3 grating = uFoilGratings[number];
	return SurfacePoint(
		grating.x * p.tangent + grating.y * p.bitangent,
		grating.x * p.bitangent - grating.y * p.tangent,
		p.normal, grating.z, strength, vec2(0.0)
	);
}

// Radiance (XYZ) towards wo from one light, the mean over the pixel's gratings. wi, wo: unit, view space.
vec3 surfaceRadianceFromLight(SurfacePoint p, vec3 wi, vec3 wo, LightSpectrum light) {
	vec3 xyz = vec3(0.0);
	// Most gratings are dark under one light: with v along its grooves a grating is seen only within its lobe's reach of
	// v = 0. The lit ones are found first, so that neighbouring pixels sum as many as each of them has.
	vec3 sum = wi + wo;
	vec2 uv = vec2(dot(sum, p.tangent), dot(sum, p.bitangent));
	float tilt = (dot(wo, p.normal) + 1.0) * uRoughness;  // no order's w is more
	float variance = uWindowVariance / (WAVENUMBER_MIN * WAVENUMBER_MIN) + tilt * tilt + light.angularRadius * light.angularRadius;
	float reach2 = 2.0 * EXPONENT_CUT * variance;
	uint lit = 0u;
	for (int k = 0; k < FOIL_GRATINGS; k++) {
		float v = uFoilGratings[k].x * uv.y - uFoilGratings[k].y * uv.x;
		if (v * v <= reach2) lit |= 1u << k;
	}
	int layer = -1;
	vec4 shares;
	for (lit &= foilFootprint.present; lit != 0u; lit &= lit - 1u) {
		int number = lowestBit(lit);
		if (number / 4 != layer) {
			layer = number / 4;
			shares = foilShares(layer) / p.strength;
		}
		SurfacePoint grating = foilGrating(p, number, shares[number % 4]);
		xyz += grating.strength * gratingRadianceFromLight(grating, wi, wo, light);
	}
	return xyz;
}

#ifdef ENVIRONMENT
// Radiance (XYZ) towards wo from the environment, the mean over the pixel's gratings. wo: unit, view space.
vec3 surfaceRadianceFromEnvironment(SurfacePoint p, vec3 wo) {
	vec3 xyz = vec3(0.0);
	int layer = -1;
	vec4 shares;
	for (uint left = foilFootprint.present; left != 0u; left &= left - 1u) {
		int number = lowestBit(left);
		if (number / 4 != layer) {
			layer = number / 4;
			shares = foilShares(layer) / p.strength;
		}
		SurfacePoint grating = foilGrating(p, number, shares[number % 4]);
		#ifdef PLANAR_TEXELS
		vec3 radiance = planarRadiance(grating, wo, number);
		#else
		vec3 radiance = gratingRadianceFromEnvironment(grating, wo);
		#endif // PLANAR_TEXELS
		xyz += grating.strength * radiance;
	}
	return xyz;
}
#endif // ENVIRONMENT
