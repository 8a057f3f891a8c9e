// What a surface diffracts of all lights and of the environment, summed up while three loops over its lights.

#define LIGHT_COUNT (NUM_POINT_LIGHTS + NUM_SPOT_LIGHTS + NUM_SUN_LIGHTS + NUM_DIR_LIGHTS)
#if LIGHT_COUNT > 0
uniform float uLightAngularRadii[LIGHT_COUNT];  // rad, in the order of three's loop: point, spot, sun, directional
#endif // LIGHT_COUNT

vec3 diffractedXyz = vec3(0.0);  // signed: gamut mapping comes once, at the end

#if LIGHT_COUNT > 0
int lightIndex = 0;

// The light of which three's loop has the colour (irradiance on a plane that faces it, linear sRGB): call it once a light.
LightSpectrum nextLight(vec3 color) {
	return LightSpectrum(color, uLightAngularRadii[lightIndex++]);
}
#endif // LIGHT_COUNT
