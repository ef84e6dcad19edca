/* A lit picture in the page. */
uniform sampler2D u_lit;
uniform usampler2D u_seen;      // view_gl_target
uniform uint u_marked;          // 1 + the instance that has a rim; 0: none
uniform vec4 u_depth;           // a, b, whether there is a sky and ground
out vec4 o_color;
bool is_marked(ivec2 at) {
	uvec4 seen = texelFetch(u_seen, clamp(at, ivec2(0), textureSize(u_seen, 0) - 1), 0);
	return seen.x == u_marked && !is_summary(seen);
}
/* How much of a pixel is rim: all of it beside the instance, a little upon it. */
float rim_at(ivec2 at) {
	if (u_marked == 0u) return 0.0;
	if (is_marked(at)) return 0.12;
	for (int i = 0; i < 9; i++)
		if (is_marked(at + ivec2(i % 3 - 1, i / 3 - 1) * 2)) return 1.0;
	return 0.0;
}
void main() {
	vec2 size = vec2(textureSize(u_seen, 0));
	uvec4 seen = texelFetch(u_seen, ivec2(min(v_at * size, size - 1.0)), 0);
	float nearness = uintBitsToFloat(seen.z);
	if (u_depth.w == 0.0 && seen.x == 0u && !is_summary(seen)) nearness = 0.0;
	if (nearness == 0.0 && u_depth.z == 0.0) discard;
	gl_FragDepth = nearness == 0.0 ? 1.0 : clamp(u_depth.x + u_depth.y * nearness, 0.0, 1.0);
	vec3 c = mix(texture(u_lit, v_at).rgb, vec3(1.0, 0.75, 0.1), rim_at(ivec2(v_at * size)));
	o_color = vec4(c, 1.0);
}
