// A relief's spectrum in cells: radiance from the environment (docs/theory.md, section 7). Each cell of spatial frequencies
// is looked up once for each node of the light's spectrum, where its centroid sends the light, with a blur as wide as it.
// Needs environmentRadiance().

uniform highp sampler2D uCells;        // centroid (x, y) and deviation along an axis, 1/µm; a column a cell, the first is order 0
uniform highp sampler2D uCellPowers;   // Σ|A|² of a cell's lines and its step to the next p = w/λ; p along x, a row a cell
uniform highp sampler2D uEnvironmentNodes;

// Power of a cell. p: w/λ, 1/µm, 0 to CELL_PHASE_MAX.
float cellPower(int cell, float p) {
	float column = min(p / CELL_PHASE_MAX, 1.0) * float(CELL_PHASES - 1);
	int i = int(column);
	vec2 texel = texelFetch(uCellPowers, ivec2(i, cell), 0).rg;
	return texel.r + (column - float(i)) * texel.g;
}

// Radiance (XYZ) towards wo from the environment. wo: unit, view space.
vec3 surfaceRadianceFromEnvironment(SurfacePoint p, vec3 wo) {
	vec3 o = inFrame(p, wo);
	if (o.z <= 0.0) return vec3(0.0);
	vec3 xyz = vec3(0.0);
	for (int k = 0; k < ENVIRONMENT_NODES; k++) {
		SpectralNode node = spectralNode(uEnvironmentNodes, k);
		vec3 seen = vec3(0.0);
		for (int cell = 0; cell < CELLS; cell++) {
			vec3 place = texelFetch(uCells, ivec2(cell, 0), 0).xyz;
			vec2 xy = node.wavelength * place.xy - o.xy;
			float z2 = 1.0 - dot(xy, xy);
			if (z2 <= 0.0) continue;
			vec3 i = vec3(xy, sqrt(z2));
			// Deviation of where the cell's light comes from, in the plane of the surface: by its lines, and by the node's
			// band, a box of which 1/√12 is the deviation.
			float band = ARC_FILTER * length(place.xy) * node.bandwidth;
			float blur = sqrt(node.wavelength * node.wavelength * place.z * place.z + band * band / 12.0);
			float tilt = (o.z + i.z) * uRoughness;
			// A mip level read bilinearly blurs as a Gaussian of half its texel: footprint = 2 standard deviations. In directions,
			// what lies in the plane is longer by 1/cosθ.
			float stretched = blur / max(i.z, 0.05);
			float footprint = 2.0 * sqrt(stretched * stretched + tilt * tilt);
			vec3 radiance = environmentRadiance(p.tangent * i.x + p.bitangent * i.y + p.normal * i.z, footprint);
			float power = cellPower(cell, (o.z + i.z) / node.wavelength);
			// 1/cosθ_i has a finite mean over a cell that ends at the horizon: cosθ there is about √(2 · blur).
			vec3 raised = vec3(i.xy, max(i.z, sqrt(2.0 * blur)));
			seen += radiance * (power * kirchhoffFactor(raised, o) * reflectance(i, o));
		}
		xyz += node.tints * seen;
	}
	return xyz;
}
