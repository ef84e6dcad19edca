/* u_count 0: light of sRGB colours; else sRGB colours of the mean of so many. */
uniform sampler2D u_from;
uniform float u_count;
out vec4 o_color;
void main() {
	vec3 c = texelFetch(u_from, ivec2(gl_FragCoord.xy), 0).rgb;
	o_color = vec4(u_count > 0.0 ? bytes_of_light(c / u_count) : light_of_bytes(c), 1.0);
}
