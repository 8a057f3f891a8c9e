// Spectra, as the tables of precompute/lobes.py hold them, seen in the metal: colours come multiplied by its reflectance.
// Wavelengths λ in µm, wavenumbers s = 1/λ in 1/µm.

uniform highp sampler2D uLobeTable;  // X, Y, Z, mean wavenumber over (position, log width); white, red, green, one above the other

// A node stands for a band of the spectrum.
struct SpectralNode {
	float wavelength;   // µm, where the band's weight has its middle
	float bandwidth;    // µm
	mat3 tints;         // XYZ of the band in light of the red, green and blue basis
};

// Node `index` of a texture of one column a node; its rows: XYZ of white and λ, of red and bandwidth, of green.
SpectralNode spectralNode(highp sampler2D nodes, int index) {
	vec4 white = texelFetch(nodes, ivec2(index, 0), 0);
	vec4 red = texelFetch(nodes, ivec2(index, 1), 0);
	vec3 green = texelFetch(nodes, ivec2(index, 2), 0).xyz;
	return SpectralNode(white.w, red.w, mat3(red.xyz, green, white.xyz - red.xyz - green));
}

// A node as a light shows it.
struct LitNode {
	vec3 color;         // XYZ of the band
	float wavelength;   // µm
	float bandwidth;    // µm
};

// A node in light of that tint (linear sRGB).
LitNode litNode(highp sampler2D nodes, int index, vec3 tint) {
	#ifdef TINTED
	SpectralNode node = spectralNode(nodes, index);
	return LitNode(node.tints * tint, node.wavelength, node.bandwidth);
	#else
	vec4 white = texelFetch(nodes, ivec2(index, 0), 0);
	// Grey: the three are equal.
	return LitNode(white.xyz * tint.g, white.w, texelFetch(nodes, ivec2(index, 1), 0).w);
	#endif // TINTED
}

// Colour (XYZ, white light's Y = 1) and mean wavenumber (w, 1/µm) of a lobe that is a Gaussian in wavenumber, normalised
// to 1: precompute/lobes.py, T(s*, q). wavenumber: s*, 1/µm, of any sign; width: q, 1/µm, within the table;
// tint: linear sRGB of the light.
vec4 lobeColor(float wavenumber, float width, vec3 tint) {
	float low = WAVENUMBER_MIN - LOBE_MARGIN * width;
	float x = (wavenumber - low) / (WAVENUMBER_MAX - WAVENUMBER_MIN + 2.0 * LOBE_MARGIN * width);
	if (x < 0.0 || x > 1.0) return vec4(0.0, 0.0, 0.0, WAVENUMBER_MIN);
	float y = clamp(log(width / LOBE_WIDTH_MIN) / log(LOBE_WIDTH_MAX / LOBE_WIDTH_MIN), 0.0, 1.0);
	vec2 texels = vec2(LOBE_POSITIONS, 3.0 * LOBE_WIDTHS);
	vec2 uv = (0.5 + vec2(x * (LOBE_POSITIONS - 1.0), y * (LOBE_WIDTHS - 1.0))) / texels;
	vec4 white = textureLod(uLobeTable, uv, 0.0);
	#ifdef TINTED
	vec4 red = textureLod(uLobeTable, uv + vec2(0.0, 1.0 / 3.0), 0.0);
	vec4 green = textureLod(uLobeTable, uv + vec2(0.0, 2.0 / 3.0), 0.0);
	vec3 blue = max(white.xyz - red.xyz - green.xyz, 0.0);  // rounding of halves may leave −1e-4
	vec3 xyz = mat3(red.xyz, green.xyz, blue) * tint;
	// Energies and first moments are linear in the tint, the mean is their ratio.
	vec3 energies = tint * vec3(dot(red.xyz, vec3(1.0)), dot(green.xyz, vec3(1.0)), dot(blue, vec3(1.0)));
	float whiteEnergy = dot(white.xyz, vec3(1.0));
	float blueMoment = whiteEnergy * white.w
		- dot(red.xyz, vec3(1.0)) * red.w - dot(green.xyz, vec3(1.0)) * green.w;
	float moment = energies.r * red.w + energies.g * green.w + tint.b * blueMoment;
	float energy = energies.r + energies.g + energies.b;
	// Where there is next to no light the ratio loses its digits, and its value no longer matters.
	float mean = energy > 1e-3 ? clamp(moment / energy, WAVENUMBER_MIN, WAVENUMBER_MAX) : white.w;
	return vec4(xyz, mean);
	#else
	return vec4(white.xyz * tint.g, white.w);  // grey: the three are equal
	#endif // TINTED
}
