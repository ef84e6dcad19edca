/* This text comes before all fragment shaders of web_program.c: words of the texts that C compiles, too, but for
 * what each of them says itself. */
#define LIGHT
#define real float
vec3 add(vec3 a, vec3 b) { return a + b; }
vec3 scale(vec3 a, float t) { return a * t; }
vec3 times(vec3 a, vec3 b) { return a * b; }
vec3 blend(vec3 a, vec3 b, float t) { return mix(a, b, t); }
vec3 unit(vec3 a) { return a / max(length(a), 1e-20); }

/* Whether what is seen (view_gl_target) is a point of a summary. */
bool is_summary(uvec4 seen) { return seen.y >> 24 == 129u; }

/* Light of sRGB colours, in [0, 1], and sRGB colours of light. */
vec3 light_of_bytes(vec3 c) {
	return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(0.04045, c));
}
vec3 bytes_of_light(vec3 c) {
	return mix(c * 12.92, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));
}
