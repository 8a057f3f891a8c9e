// A foil of many gratings: a pixel that covers a few texels shows the mean of their radiance, one that covers many that of
// clusters of gratings that are much alike (web/surfaces/foil-clusters.ts).

// A layer for each cluster: its share of the place; this times the means of its gratings' turn and change, and of the sum of
// their squares. Then one of the share of the place that diffracts, and one that holds the centres.
uniform mediump sampler2DArray uFoilClusters;
uniform vec2 uFoilReach;     // units of turn, rad, and of change, 1/µm: the furthest off a centre that a grating is
#ifdef ENVIRONMENT
// Fewer clusters, of smaller places: an environment is smooth in orientation, and each cluster is a whole arc of it.
uniform mediump sampler2DArray uFoilArcClusters;
uniform vec2 uFoilArcReach;
#endif // ENVIRONMENT

// A smaller share is none.
#define SMALLEST_SHARE 0.001
// A cluster with a smaller share of the pixel is not worth an arc.
#define FOIL_LEAST_ARC 0.01
// Texels are read one by one at twice as many places along each side as the pixel is texels wide, as long as these suffice.
#define FOIL_MOST_TAPS 8.0
#define FOIL_MOST_TEXELS 8.0
// A texel that a light lights by less than exp(−CUT) of its most is dark.
#define FOIL_CUT 8.0

struct FoilFootprint {
	float taps;      // along each side of the pixel; 0 where clusters are read
	vec2 uv;         // of its middle, in tiles
	vec2 alongX;     // change of uv over the pixel
	vec2 alongY;
};
FoilFootprint foilFootprint;

// The mean over the pixel of a layer of clusters. A texture unit weighs texels by a tent twice as wide as one of them: a row of
// readings that lie a texel apart makes an even sum. So few of them along each side as that takes at some whole level.
#define FOIL_MOST_READINGS 10.0
vec4 foilMean(sampler2DArray clusters, int layer) {
	vec2 texels = vec2(textureSize(clusters, 0));
	float width = max(length(foilFootprint.alongX * texels), length(foilFootprint.alongY * texels));
	float level = max(ceil(log2(width / FOIL_MOST_READINGS)), 0.0);
	float readings = max(floor(width * exp2(-level) + 0.5), 1.0);
	vec2 x = foilFootprint.alongX / readings, y = foilFootprint.alongY / readings;
	vec4 sum = vec4(0.0);
	for (float i = 0.0; i < readings; i++)
		for (float j = 0.0; j < readings; j++) {
			vec2 at = vec2(i, j) - 0.5 * (readings - 1.0);
			sum += textureLod(clusters, vec3(foilFootprint.uv + at.x * x + at.y * y, layer), level);
		}
	return sum / (readings * readings);
}

// The grating at one of the pixel's taps: cos θ, sin θ, frequency in 1/µm, strength.
vec4 foilTap(int number) {
	float taps = foilFootprint.taps;
	vec2 at = (vec2(number % int(taps), number / int(taps)) - 0.5 * (taps - 1.0)) / taps;
	return foilTexel(foilFootprint.uv + at.x * foilFootprint.alongX + at.y * foilFootprint.alongY);
}

// A cluster's centre: cos θ, sin θ, frequency in 1/µm, and which part of the sum of squares turn has.
vec4 foilCentre(sampler2DArray clusters, int count, int number) {
	int columns = textureSize(clusters, 0).x;
	return texelFetch(clusters, ivec3(number % columns, number / columns, count + 1), 0);
}

// A cluster's gratings in the pixel: their mean's cos θ, sin θ, frequency in 1/µm, and share of the pixel. spread: the
// variances of their grating vectors along and across the mean, 1/µm².
vec4 foilCluster(sampler2DArray clusters, int count, vec2 reach, int number, out vec2 spread) {
	vec4 texel = foilMean(clusters, number);
	vec4 centre = foilCentre(clusters, count, number);
	vec3 moments = texel.yzw / max(texel.x, SMALLEST_SHARE);
	vec2 mean = clamp(moments.xy, -1.0, 1.0);
	float variance = max(moments.z - dot(mean, mean), 0.0);
	mean *= reach;
	float frequency = centre.z + mean.y;
	spread = variance * vec2(centre.w, 1.0 - centre.w) * reach * reach;
	return vec4(cos(mean.x) * centre.xy + sin(mean.x) * vec2(-centre.y, centre.x), frequency, texel.x);
}

// The sine of how far a grating is turned from a direction in the surface, either way along it.
float foilTurn(vec2 grating, vec2 towards) {
	float turn = grating.x * towards.y - grating.y * towards.x;
	return dot(grating, towards) < 0.0 ? -turn : turn;
}

// A grating in the mesh's frame. grating: cos θ, sin θ, frequency in 1/µm; spread: of the grating vectors, as in SurfacePoint.
SurfacePoint foilGrating(SurfacePoint p, vec3 grating, vec2 spread) {
	return SurfacePoint(
		grating.x * p.tangent + grating.y * p.bitangent,
		grating.x * p.bitangent - grating.y * p.tangent,
		p.normal, grating.z, 1.0, spread
	);
}

// The mesh's frame, from which each grating's own follows, and the share of the pixel that diffracts.
SurfacePoint foilPointAt(vec3 tangent, vec3 bitangent, vec3 normal, vec2 uv) {
	vec2 alongX = dFdx(uv) * uFoilRepeat, alongY = dFdy(uv) * uFoilRepeat;
	vec2 texels = vec2(textureSize(uFoilMap, 0));
	float width = max(length(alongX * texels), length(alongY * texels));
	float taps = width <= 1.0 ? 1.0 : width <= FOIL_MOST_TEXELS ? min(ceil(2.0 * width), FOIL_MOST_TAPS) : 0.0;
	foilFootprint = FoilFootprint(taps, uv * uFoilRepeat, alongX, alongY);
	#ifdef FOIL_WHOLE
	float strength = 1.0;
	#else
	float strength = 0.0;
	if (taps == 0.0)
		strength = foilMean(uFoilClusters, FOIL_CLUSTERS).x;
	else
		for (int i = 0; i < int(taps * taps); i++) strength += foilTap(i).w / (taps * taps);
	#endif // FOIL_WHOLE
	return SurfacePoint(tangent, bitangent, normal, 0.0, strength, vec2(0.0));
}

// What a light shows of the pixel's gratings is sorted by how far they are turned from where they would be brightest, and by
// frequency: a bin holds Σ share · (1, turn, change, turn²) and Σ share · change², and is shown as one Gaussian.
struct FoilBin {
	vec4 sum;
	float change2;
};

// Radiance (XYZ) towards wo from one light, the mean over what diffracts in the pixel. wi, wo: unit, view space.
vec3 surfaceRadianceFromLight(SurfacePoint p, vec3 wi, vec3 wo, LightSpectrum light) {
	float taps = foilFootprint.taps;
	vec3 sum = wi + wo;
	vec2 uv = vec2(dot(sum, p.tangent), dot(sum, p.bitangent));
	float rho = length(uv);
	vec2 towards = rho > 1e-6 ? uv / rho : vec2(1.0, 0.0);
	// With v along its grooves a grating is seen only within its lobe's reach of v = 0.
	float tilt = (dot(wo, p.normal) + 1.0) * uRoughness;  // no order's w is more
	float variance = uWindowVariance / (WAVENUMBER_MIN * WAVENUMBER_MIN) + tilt * tilt + light.angularRadius * light.angularRadius;
	float range = min(sqrt(2.0 * FOIL_CUT * variance) / max(rho, 1e-6), 1.0);
	FoilBin bins[FOIL_TURN_BINS * FOIL_CHANGE_BINS];
	for (int b = 0; b < FOIL_TURN_BINS * FOIL_CHANGE_BINS; b++) bins[b] = FoilBin(vec4(0.0), 0.0);
	int count = taps > 0.0 ? int(taps * taps) : FOIL_CLUSTERS;
	for (int k = 0; k < count; k++) {
		vec4 grating = taps > 0.0 ? foilTap(k) : foilCentre(uFoilClusters, FOIL_CLUSTERS, k);
		float turn = foilTurn(grating.xy, towards);
		if (abs(turn) > range + (taps > 0.0 ? 0.0 : uFoilReach.x)) continue;
		vec2 spread = vec2(0.0);
		if (taps == 0.0) {
			grating = foilCluster(uFoilClusters, FOIL_CLUSTERS, uFoilReach, k, spread);
			turn = foilTurn(grating.xy, towards);
		}
		float change = grating.z - FOIL_FREQUENCY;
		vec4 moments = grating.w * vec4(1.0, turn, change, turn * turn + spread.x);
		float change2 = grating.w * (change * change + spread.y);
		// Of a texel that is alone nothing is to be sorted.
		float x = taps == 1.0 ? 0.0 : (0.5 + 0.5 * turn / range) * float(FOIL_TURN_BINS - 1);
		float y = taps == 1.0 ? 0.0 : (0.5 + change / FOIL_FREQUENCY_RANGE) * float(FOIL_CHANGE_BINS - 1);
		for (int a = 0; a < FOIL_TURN_BINS; a++)
			for (int b = 0; b < FOIL_CHANGE_BINS; b++) {
				float weight = max(1.0 - abs(x - float(a)), 0.0) * max(1.0 - abs(y - float(b)), 0.0);
				bins[a * FOIL_CHANGE_BINS + b].sum += weight * moments;
				bins[a * FOIL_CHANGE_BINS + b].change2 += weight * change2;
			}
	}
	vec3 xyz = vec3(0.0);
	for (int b = 0; b < FOIL_TURN_BINS * FOIL_CHANGE_BINS; b++) {
		FoilBin bin = bins[b];
		if (bin.sum.x <= 0.0) continue;
		vec3 means = bin.sum.yzw / bin.sum.x;
		float frequency = FOIL_FREQUENCY + means.y;
		float turn = clamp(means.x, -1.0, 1.0);
		vec2 direction = sqrt(1.0 - turn * turn) * towards + turn * vec2(towards.y, -towards.x);
		// As maps state it; a profile need not be symmetric.
		if (direction.x < 0.0) direction = -direction;
		vec2 spread = max(vec2(bin.change2 / bin.sum.x, means.z) - vec2(means.y * means.y, turn * turn), 0.0);
		spread.y *= frequency * frequency;
		float share = taps > 0.0 ? bin.sum.x / (taps * taps) : bin.sum.x;
		SurfacePoint grating = foilGrating(p, vec3(direction, frequency), spread);
		xyz += share * gratingRadianceFromLight(grating, wi, wo, light);
	}
	return xyz / max(p.strength, SMALLEST_SHARE);
}

#ifdef ENVIRONMENT
// Radiance (XYZ) towards wo from the environment, the mean over what diffracts in the pixel. wo: unit, view space.
vec3 surfaceRadianceFromEnvironment(SurfacePoint p, vec3 wo) {
	bool isTexel = foilFootprint.taps == 1.0;
	uint present = 0u;
	float strength = 0.0;
	vec2 texels = vec2(textureSize(uFoilArcClusters, 0));
	float level = max(log2(max(length(foilFootprint.alongX * texels), length(foilFootprint.alongY * texels))), 0.0);
	for (int k = 0; k < FOIL_ARC_CLUSTERS; k++) {
		float share = textureLod(uFoilArcClusters, vec3(foilFootprint.uv, k), level).x;
		if (share > FOIL_LEAST_ARC) present |= 1u << k;
	}
	if (isTexel) present = 1u;
	vec3 xyz = vec3(0.0);
	for (; present != 0u; present &= present - 1u) {
		int number = lowestBit(present);
		vec2 spread = vec2(0.0);
		vec4 grating = isTexel
			? foilTap(0)
			: foilCluster(uFoilArcClusters, FOIL_ARC_CLUSTERS, uFoilArcReach, number, spread);
		strength += grating.w;
		spread = vec2(spread.y, grating.z * grating.z * spread.x);
		xyz += grating.w * gratingRadianceFromEnvironment(foilGrating(p, grating.xyz, spread), wo);
	}
	return xyz / max(strength, SMALLEST_SHARE);
}
#endif // ENVIRONMENT
