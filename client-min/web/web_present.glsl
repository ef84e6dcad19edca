/* A lit picture in the page. */
uniform sampler2D u_lit;
uniform usampler2D u_seen;      // view_gl_target
uniform vec4 u_depth;           // a, b, whether there is a sky and ground
out vec4 o_color;
void main() {
	vec2 size = vec2(textureSize(u_seen, 0));
	uvec4 seen = texelFetch(u_seen, ivec2(min(v_at * size, size - 1.0)), 0);
	float nearness = uintBitsToFloat(seen.z);
	if (u_depth.w == 0.0 && seen.x == 0u && !is_summary(seen)) nearness = 0.0;
	if (nearness == 0.0 && u_depth.z == 0.0) discard;
	gl_FragDepth = nearness == 0.0 ? 1.0 : clamp(u_depth.x + u_depth.y * nearness, 0.0, 1.0);
	o_color = vec4(texture(u_lit, v_at).rgb, 1.0);
}
