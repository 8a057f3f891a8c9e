uniform mat3 uXyzToRgb;  // XYZ to linear sRGB

// Colour outside the display's gamut → inside it, both linear sRGB of any scale: the smallest step towards grey of
// the same luminance that leaves no channel negative. Luminance is kept; hue as straight lines in XYZ keep it.
// Colours without luminance have nothing to keep and become black. Needs three's luminance().
vec3 gamutMapped(vec3 rgb) {
	float y = luminance(rgb);
	if (y <= 0.0) return vec3(0.0);
	float lowest = min(min(rgb.r, rgb.g), rgb.b);
	// lowest + k (y − lowest) = 0; y > 0 ≥ lowest, so there is no division by zero.
	float k = lowest < 0.0 ? lowest / (lowest - y) : 0.0;
	// The channel that was lowest lands on zero but for rounding.
	return max(mix(rgb, vec3(y), k), 0.0);
}
