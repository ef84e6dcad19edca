#include "client-min/web/web_light.h"

#include <GLES3/gl3.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/draw/view_gpu.h"
#include "client-min/draw/view_light.h"
#include "client-min/view_record.h"
#include "client-min/web/web_program.h"
#include "ecofiles/base/array_grow.h"

#define PLANT_TEXELS 3
#define BLOCK 1024u                      /* texels of the coarsest level of a tile of the ground's image */

/* The language of view_light.glsl; places on the ground are metres from the eye. */
static const char language[] = WEB_LANGUAGE
	"#define ground_place vec2\n"
	"float noise_at(vec2 at, int which, int finer);\n";

static const char light_text[] =
#include "view_light_text.h"
	;

/* Values that all pixels share come to them from the vertices: software drivers look up a uniform for
 * each pixel (lod/EXPERIMENTS.md, A frame's time). u_frame: where the sun is and the day, its light and its
 * glow, the sky's and haze_m, the earth's and by_kind, from where feet are told to the eye and the shift of
 * plants, u_shade's corner from the eye and 1 / its side. u_part, u_cell: where the eye is in octaves, two a
 * vector. 14 vectors of the 15 that any driver has. */
#define FRAME \
	"FLAT vec4 v_frame[6], v_part[3];\n" \
	"FLAT ivec4 v_cell[3];\n" \
	"uniform usampler2D u_seen;\n"

static const char more[] = FRAME
	"uniform vec4 u_frame[6], u_part[3];\n"
	"uniform ivec4 u_cell[3];\n"
	"uniform mat3 u_ray;             // the image plane's half extents, and its middle\n"
	"out vec3 v_ray;\n"
	"out vec2 v_pixel;\n"
	"void more() {\n"
	"	v_frame = u_frame;\n"
	"	v_part = u_part;\n"
	"	v_cell = u_cell;\n"
	"	v_ray = u_ray * vec3(gl_Position.x, -gl_Position.y, 1.0);\n"
	"	v_pixel = (gl_Position.xy * 0.5 + 0.5) * vec2(textureSize(u_seen, 0));\n"
	"}\n";

static const char plain_text[] =
	"vec3 ground_own(vec3 n, vec3 to) { return ground_albedo(to.xy, n.z, length(to)); }\n";

/* vec3 ground_own(vec3 n, vec3 to), the ground's own colour, by its image. */
static const char image_text[] = "#define wide float\n"
	"#define widened(x) (x)\n"
	"#define whole(x) uint(x)\n"
	"#define tree ivec3\n"
	"uniform usampler2D u_nodes;\n"
	"uniform sampler2D u_texels;\n"
	"uniform ivec3 u_tree;           // log2 of their widths, where blocks begin\n"
	"uniform vec4 u_image;           // the eye in the root, 1 / its side, radians of a pixel\n"
#include "view_image_text.h"
	"ivec2 texel_of(int shift, uint i) { return ivec2(int(i) & ((1 << shift) - 1), int(i) >> shift); }\n"
	"uint tree_node(tree t, uint i) { return texelFetch(u_nodes, texel_of(t.x, i), 0).x; }\n"
	"uint tree_level(tree t, uint leaf, uint level) {\n"
	"	return tree_node(t, uint(t.z) + 4u * (leaf & 0x1fffffffu) + level) * 1024u;\n"
	"}\n"
	"image_color tree_texel(tree t, uint of, uint texel) {\n"
	"	vec4 c = texelFetch(u_texels, texel_of(t.y, of + texel), 0);\n"
	"	return image_color(c.r * c.a, c.g * c.a, c.b * c.a, c.a, 0.0);\n"
	"}\n"
	"vec3 ground_own(vec3 n, vec3 to) {\n"
	"	footprint foot = footprint_of(n, to, u_image.w);\n"
	"	vec2 at = u_image.xy + to.xy * u_image.z, along = vec2(foot.x, foot.y) * u_image.z;\n"
	"	image_color c = image_seen(u_tree, image_pixel(at.x, at.y, along.x, along.y,\n"
	"		foot.across * u_image.z));\n"
	"	return imaged_albedo(to.xy, n.z, length(to), vec3(c.red, c.green, c.blue), c.alpha,\n"
	"		c.texel / u_image.z);\n"
	"}\n";

static const char unshadowed_text[] =
	"vec2 cast_at(vec3 to, vec3 n, bool facet) { return vec2(-1.0, 0.0); }\n";

static const char pixels[] = FRAME
	"uniform sampler2D u_shade;\n"
	"uniform usampler2D u_plants;\n"
	"in vec3 v_ray;\n"
	"in vec2 v_pixel;\n"
	"out vec4 o_color;\n"
	WEB_IS_SUMMARY
	"sunlight sun() {\n"
	"	return sunlight(v_frame[0].xyz, v_frame[1].xyz, v_frame[2].xyz, v_frame[3].xyz, v_frame[0].w,\n"
	"		v_frame[1].w);\n"
	"}\n"
	"float haze_m() { return v_frame[2].w; }\n"
	"bool by_kind() { return v_frame[3].w != 0.0; }\n"
	"float noise_at(vec2 at, int which, int finer) {\n"
	"	bool odd = (which & 1) == 1;\n"
	"	vec4 part = v_part[which >> 1], metre = METRE[which];\n"
	"	ivec4 base = v_cell[which >> 1];\n"
	"	vec2 p = float(finer) * ((odd ? part.zw : part.xy) + metre.xy * at.x + metre.zw * at.y), cell = floor(p);\n"
	"	uvec2 whole = uvec2(finer * (odd ? base.zw : base.xy) + ivec2(cell));\n"
	"	return noise_in(whole.x, whole.y, p.x - cell.x, p.y - cell.y);\n"
	"}\n"
	"vec4 plant_texel(uint i) {\n"
	"	int shift = int(v_frame[4].w);\n"
	"	ivec2 at = ivec2(int(i) & ((1 << shift) - 1), int(i) >> shift);\n"
	"	return uintBitsToFloat(texelFetch(u_plants, at, 0));\n"
	"}\n"
	WEB_SRGB
	/* of a pixel; foot: of the plant, and its scale */
	"plant plant_of(uvec4 seen, out vec4 foot) {\n"
	"	foot = vec4(0.0, 0.0, 0.0, 1.0);\n"
	"	if (is_summary(seen)) return plant(0.0, 0.0, 0.0, 0.0, 0.0, summary_tone(seen.x >> 2));\n"
	"	uint at = (seen.x - 1u) * 3u;\n"
	"	vec4 a = plant_texel(at), b = plant_texel(at + 2u);\n"
	"	foot = plant_texel(at + 1u);\n"
	"	return plant(a.x, a.y, a.z, a.w, b.x, b.y);\n"
	"}\n"
	/* sunshine: what a shadow map says, the share of sunlight that arrives and how large a texel is */
	"vec3 plant_pixel(uvec4 seen, vec3 to, plant p, vec4 foot, face look, vec2 sunshine) {\n"
	"	vec3 own = light_of_bytes(vec3(uvec3(seen.w, seen.w >> 8, seen.w >> 16) & 255u) / 255.0);\n"
	"	return plant_color(sun(), p, own, look, (to + v_frame[4].xyz - foot.xyz) / foot.w, to,\n"
	"		sunshine.x, sunshine.y, foot.w, haze_m(), by_kind());\n"
	"}\n"
	"vec3 ground_pixel(vec3 n, vec3 to, vec2 sunshine) {\n"
	"	vec2 at = (to.xy - v_frame[5].xy) * v_frame[5].z, taken = vec2(0.0);\n"
	"	if (all(greaterThan(at, vec2(0.0))) && all(lessThan(at, vec2(1.0))))\n"
	"		taken = textureLod(u_shade, at, 0.0).rg;\n"
	"	vec3 lit = ground_light(sun(), n, sunshine.x < 0.0 ? taken.x : 1.0 - sunshine.x, taken.y);\n"
	"	lit *= ground_own(n, to);\n"
	"	return ground_color(sun(), lit, to, haze_m(), by_kind());\n"
	"}\n"
	"vec3 color_of(uvec4 seen, vec3 to) {\n"
	"	bool ground = seen.x == 0u && !is_summary(seen);\n"
	"	vec4 foot;\n"
	"	plant p = plant_of(seen, foot);\n"
	"	face look = face(sunny(0.0, 0.0, 0.0), direction_of(seen.y), true, 0.0, 0.0);\n"
	"	if (!ground) look = face_of(sun(), p, seen.y, -unit(to));\n"
	"	vec2 sunshine = cast_at(to, look.n, look.facet);\n"
	"	if (ground) return ground_pixel(look.n, to, sunshine);\n"
	"	return plant_pixel(seen, to, p, foot, look, sunshine);\n"
	"}\n"
	"void main() {\n"
	"	uvec4 seen = texelFetch(u_seen, ivec2(v_pixel), 0);\n"
	"	float nearness = uintBitsToFloat(seen.z);\n"
	"	vec3 color = nearness == 0.0 ? sky_color(sun(), v_ray, by_kind())\n"
	"		: color_of(seen, v_ray / nearness);\n"
	"	o_color = vec4(bytes_of_light(vec3(shown(color.x), shown(color.y), shown(color.z))), 1.0);\n"
	"}\n";

/* ---- A lit picture in the page ---- */

static const char present_text[] = WEB_IS_SUMMARY
	"uniform sampler2D u_lit;\n"
	"uniform usampler2D u_seen;      // view_gl_target\n"
	"uniform vec4 u_depth;           // a, b, whether there is a sky and ground\n"
	"out vec4 o_color;\n"
	"void main() {\n"
	"	vec2 size = vec2(textureSize(u_seen, 0));\n"
	"	uvec4 seen = texelFetch(u_seen, ivec2(min(v_at * size, size - 1.0)), 0);\n"
	"	float nearness = uintBitsToFloat(seen.z);\n"
	"	if (u_depth.w == 0.0 && seen.x == 0u && !is_summary(seen)) nearness = 0.0;\n"
	"	if (nearness == 0.0 && u_depth.z == 0.0) discard;\n"
	"	gl_FragDepth = nearness == 0.0 ? 1.0 : clamp(u_depth.x + u_depth.y * nearness, 0.0, 1.0);\n"
	"	o_color = vec4(texture(u_lit, v_at).rgb, 1.0);\n"
	"}\n";

/* ---- The image on the ground ---- */

static uint64_t blocks_of(uint32_t level) { return 1u << 2 * level; }

static const struct web_image_slot *find(const struct web_image *image, const struct view_image_tile *tile)
{
	uint32_t index = view_table_get(&image->table, tile->list->id);
	return index == UINT32_MAX ? NULL : &image->slots[index];
}

/* Blocks of what the tiles show; of what is not uploaded only, or of all. */
static uint64_t count_blocks(const struct web_image *image, const struct view_image *of, bool all)
{
	uint64_t blocks = 0;
	for (uint32_t i = 0; i < of->count; i++) {
		const struct web_image_slot *slot = all ? NULL : find(image, &of->tiles[i]);
		for (uint32_t level = slot ? slot->levels : 0; level < of->tiles[i].levels; level++)
			blocks += blocks_of(level);
	}
	return blocks;
}

static void forget_image(struct web_image *image)
{
	view_table_free(&image->table);
	free(image->slots);
	image->slots = NULL;
	image->count = image->room = 0;
	image->blocks = 0;
}

static enum eco_code make_room(struct web_image *image, struct view_gpu *gpu, const struct view_image *of,
	struct eco_error *error)
{
	if ((image->blocks + count_blocks(image, of, false)) * BLOCK <= image->texels.room)
		return ECO_OK;
	forget_image(image);
	return view_gpu_room(gpu, &image->texels, VIEW_GPU_COLOR, count_blocks(image, of, true) * BLOCK,
		error);
}

static enum eco_code upload_level(const struct web_image *image, const struct eco_texture_part *part,
	struct eco_error *error)
{
	size_t count = (size_t)part->width * part->height;
	uint8_t *rgba = malloc(4 * count);
	if (!rgba)
		return eco_no_memory(error, "the image of the ground");
	for (size_t i = 0; i < count; i++) {
		const uint8_t *texel = part->texels + i * part->channels;
		memcpy(rgba + 4 * i, texel, 3);
		rgba[4 * i + 3] = part->channels == 4 ? texel[3] : 255;
	}
	view_gpu_write(&image->texels, image->blocks * BLOCK, rgba, count);
	free(rgba);
	return ECO_OK;
}

static enum eco_code upload_tile(struct web_image *image, const struct view_image_tile *tile,
	struct eco_error *error)
{
	uint32_t index = view_table_get(&image->table, tile->list->id);
	if (index == UINT32_MAX) {
		if (!eco_array_grow(&image->slots, &image->room, image->count, sizeof *image->slots)
				|| !view_table_put(&image->table, tile->list->id, image->count))
			return eco_no_memory(error, "the image of the ground");
		index = image->count++;
		image->slots[index].levels = 0;
	}
	struct web_image_slot *slot = &image->slots[index];
	enum eco_code code = ECO_OK;
	for (; slot->levels < tile->levels && !code; slot->levels += !code) {
		code = upload_level(image, &tile->list->parts[slot->levels], error);
		slot->block[slot->levels] = (uint32_t)image->blocks;
		image->blocks += code ? 0 : blocks_of(slot->levels);
	}
	return code;
}

static enum eco_code upload_tree(struct web_image *image, struct view_gpu *gpu, const struct view_image *of,
	struct eco_error *error)
{
	size_t count = of->node_count + (size_t)of->count * ECO_GROUND_IMAGE_LEVELS;
	uint32_t *words = malloc(count * sizeof *words);
	if (!words)
		return eco_no_memory(error, "the image of the ground");
	memcpy(words, of->nodes, of->node_count * sizeof *words);
	for (uint32_t i = 0; i < of->count; i++)
		memcpy(words + of->node_count + i * ECO_GROUND_IMAGE_LEVELS, find(image,
			&of->tiles[i])->block,
			ECO_GROUND_IMAGE_LEVELS * sizeof *words);
	enum eco_code code = view_gpu_stream(gpu, &image->nodes, VIEW_GPU_WORD, words, count, error);
	free(words);
	image->node_count = of->node_count;
	return code;
}

static enum eco_code upload_ground(struct web_image *image, struct view_gpu *gpu, const struct view_image *of,
	struct eco_error *error)
{
	enum eco_code code = make_room(image, gpu, of, error);
	for (uint32_t i = 0; i < of->count && !code; i++)
		code = upload_tile(image, &of->tiles[i], error);
	return code ? code : upload_tree(image, gpu, of, error);
}

static void free_image(struct web_image *image)
{
	const unsigned textures[] = { image->nodes.texture, image->texels.texture };
	glDeleteTextures(2, textures);
	forget_image(image);
	*image = (struct web_image){ 0 };
}

/* ---- Life ---- */

/* How far a metre to the east and one to the north go in each octave. */
static void say_metre(char *text, size_t size)
{
	int at = snprintf(text, size, "const vec4 METRE[6] = vec4[6](");
	for (int i = 0; i < VIEW_OCTAVES; i++) {
		double zero[2], east[2], north[2];
		view_light_octave(i, (const double[2]){ 0, 0 }, zero);
		view_light_octave(i, (const double[2]){ 1, 0 }, east);
		view_light_octave(i, (const double[2]){ 0, 1 }, north);
		at += snprintf(text + at, size - (size_t)at, "%svec4(%.9g, %.9g, %.9g, %.9g)", i ? ", " : "",
			east[0] - zero[0], east[1] - zero[1], north[0] - zero[0], north[1] - zero[1]);
	}
	snprintf(text + at, size - (size_t)at, ");\n");
}

enum eco_code web_light_prepare(struct web_light *light, bool image, bool shadows, struct eco_error *error)
{
	unsigned *program = &light->programs[image][shadows];
	char metre[1024];
	if (!light->lit.vertex_array) {
		view_gpu_init(&light->gpu);
		glGenVertexArrays(1, &light->lit.vertex_array);
		glGenFramebuffers(1, &light->lit.framebuffer);
		light->present = web_program(NULL, (const char *const[]){ present_text }, 1, "pictures", error);
	}
	if (!light->present)
		return ECO_UNSUPPORTED;
	if (!*program) {
		say_metre(metre, sizeof metre);
		*program = web_program(more, (const char *const[]){ metre, language, light_text,
			image ? image_text : plain_text, shadows ? web_shadow_text : unshadowed_text,
			pixels }, 6, "light", error);
		if (!*program && shadows)
			light->shadow.refused = true;
	}
	light->program = *program;
	return light->program ? ECO_OK : error->code;
}

static void resize(struct web_lit *lit, uint32_t width, uint32_t height)
{
	if (lit->texture && lit->width == width && lit->height == height)
		return;
	glDeleteTextures(1, &lit->texture);
	lit->texture = view_gpu_texture(GL_RGBA8, width, height, GL_LINEAR);
	lit->width = width;
	lit->height = height;
	glBindFramebuffer(GL_FRAMEBUFFER, lit->framebuffer);
	glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, lit->texture, 0);
}

void web_light_free(struct web_light *light)
{
	const unsigned textures[] = { light->lit.texture, light->shade, light->plants.texture };
	glDeleteTextures(3, textures);
	glDeleteFramebuffers(1, &light->lit.framebuffer);
	glDeleteVertexArrays(1, &light->lit.vertex_array);
	for (int i = 0; i < 4; i++)
		glDeleteProgram(light->programs[i / 2][i % 2]);
	glDeleteProgram(light->present);
	web_shadow_free(&light->shadow);
	web_mean_free(&light->mean);
	free_image(&light->image);
	view_gpu_free(&light->gpu);
	*light = (struct web_light){ 0 };
}

void web_light_forget(struct web_light *light)
{
	light->shaded = light->held = false;
}

/* ---- What light needs of a selection ---- */

static void put_plant(float *texels, const struct view_draw_job *job, const struct view_instance *p)
{
	struct view_light_plant light;
	view_light_plant(job->store, p->plant == ECO_NONE ? NULL : p, p->owner, &light);
	const float a[4] = { light.sine, light.cosine, light.center_z, light.half_width },
		b[4] = { light.half_height, light.tone };
	memcpy(texels, a, sizeof a);
	for (int k = 0; k < 3; k++)
		texels[4 + k] = (float)(p->place.at[k] - job->eye->at[k]);
	texels[7] = (float)p->place.scale;
	memcpy(texels + 8, b, sizeof b);
}

/* Feet are told from where the eye was then. */
static enum eco_code upload_plants(struct web_light *light, const struct view_draw_job *job,
	struct eco_error *error)
{
	uint32_t count = job->selection->instance_count;
	float *texels = malloc((size_t)count * PLANT_TEXELS * VIEW_TEXEL_BYTES + 1);
	if (!texels)
		return eco_no_memory(error, "the plants in view");
	memcpy(light->origin, job->eye->at, sizeof light->origin);
	for (uint32_t i = 0; i < count; i++)
		put_plant(texels + (size_t)i * PLANT_TEXELS * 4, job, &job->selection->instances[i]);
	enum eco_code code = view_gpu_stream(&light->gpu, &light->plants, VIEW_GPU_WORDS, texels,
		(uint64_t)count * PLANT_TEXELS, error);
	free(texels);
	return code;
}

/* Once a selection. */
static enum eco_code upload_selection(struct web_light *light, const struct view_draw_job *job,
	struct eco_error *error)
{
	if (light->held)
		return ECO_OK;
	enum eco_code code = upload_plants(light, job, error);
	if (!code && job->selection->image.count)
		code = upload_ground(&light->image, &light->gpu, &job->selection->image, error);
	light->held = !code;
	return code;
}

/* The map of plants' shadows on the ground: it changes with the selection and the sun, not with the eye. */
static enum eco_code upload_shade(struct web_light *light, const struct view_draw_job *job,
	struct eco_error *error)
{
	struct view_shade shade = { .size_m = 0 };
	const float *sun = job->selection->sky.sun;
	if (light->shaded && !memcmp(light->sun, sun, sizeof light->sun))
		return ECO_OK;
	enum eco_code code = job->selection->ground.count
		? view_shade_make(&shade, job->store, job->selection, error) : ECO_OK;
	if (code)
		return code;
	if (!light->shade)
		light->shade = view_gpu_texture(GL_RG8, VIEW_SHADE_PIXELS, VIEW_SHADE_PIXELS, GL_LINEAR);
	glBindTexture(GL_TEXTURE_2D, light->shade);
	glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
	if (shade.texels)
		glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, VIEW_SHADE_PIXELS, VIEW_SHADE_PIXELS, GL_RG,
			GL_UNSIGNED_BYTE, shade.texels);
	light->low[0] = shade.low[0];
	light->low[1] = shade.low[1];
	light->side_m = shade.size_m;
	memcpy(light->sun, sun, sizeof light->sun);
	light->shaded = true;
	view_shade_free(&shade);
	return ECO_OK;
}

/* ---- Drawing ---- */

static int uniform(const struct web_light *light, const char *name)
{
	return glGetUniformLocation(light->program, name);
}

static void set_frame(const struct web_light *light, const struct view_draw_job *job)
{
	const struct lod_eye *eye = job->eye;
	struct view_light_sun sun;
	view_light_sun(&job->selection->sky, eye->at[2], &sun);
	float frame[6][4] = { [0][3] = sun.day, [1][3] = sun.glow, [2][3] = sun.haze_m,
		[3][3] = job->tint == VIEW_TINT_KIND, [4][3] = (float)light->plants.shift,
		[5][2] = light->side_m > 0 ? (float)(1 / light->side_m) : 0 };
	const float *const colors[4] = { sun.to, sun.color, sun.sky, sun.earth };
	for (int i = 0; i < 4; i++)
		memcpy(frame[i], colors[i], 3 * sizeof *frame[i]);
	for (int k = 0; k < 3; k++)
		frame[4][k] = (float)(eye->at[k] - light->origin[k]);
	for (int k = 0; k < 2; k++)
		frame[5][k] = (float)(light->low[k] - eye->at[k]);
	glUniform4fv(uniform(light, "u_frame"), 6, frame[0]);
}

static void set_rays(const struct web_light *light, const struct lod_eye *eye)
{
	const double *const axes[3] = { eye->right, eye->up, eye->forward };
	const double lengths[3] = { eye->tan_x, eye->tan_y, 1 };
	float ray[9];
	for (int i = 0; i < 9; i++)
		ray[i] = (float)(axes[i / 3][i % 3] * lengths[i / 3]);
	for (int i = 0; i < 3; i++)
		ray[6 + i] += (float)(eye->middle[0] * eye->right[i] + eye->middle[1] * eye->up[i]);
	glUniformMatrix3fv(uniform(light, "u_ray"), 1, GL_FALSE, ray);
}

/* The eye's place in each octave. */
static void set_octaves(const struct web_light *light, const struct view_draw_job *job)
{
	const double *origin = job->selection->ground.origin, *eye = job->eye->at;
	int cell[VIEW_OCTAVES][2];
	float part[VIEW_OCTAVES][2];
	for (int i = 0; i < VIEW_OCTAVES; i++) {
		double at[2];
		view_light_octave(i, (const double[2]){ eye[0] - origin[0], eye[1] - origin[1] }, at);
		for (int k = 0; k < 2; k++) {
			double whole = fabs(at[k]) < 1e15 ? floor(at[k]) : at[k];
			cell[i][k] = (int)(uint32_t)(fabs(whole) < 1e15 ? (int64_t)whole : 0);
			part[i][k] = (float)(at[k] - whole);
		}
	}
	glUniform4iv(uniform(light, "u_cell"), VIEW_OCTAVES / 2, cell[0]);
	glUniform4fv(uniform(light, "u_part"), VIEW_OCTAVES / 2, part[0]);
}

static void set_image(const struct web_image *image, unsigned program, int unit, const struct view_image *of,
	const struct lod_eye *eye)
{
	web_program_texture(program, "u_nodes", unit, image->nodes.texture);
	web_program_texture(program, "u_texels", unit + 1, image->texels.texture);
	glUniform3i(glGetUniformLocation(program, "u_tree"), (int)image->nodes.shift,
		(int)image->texels.shift,
		(int)image->node_count);
	glUniform4f(glGetUniformLocation(program, "u_image"),
		(float)((eye->at[0] - of->origin[0]) / of->side_m),
		(float)((eye->at[1] - of->origin[1]) / of->side_m), (float)(1 / of->side_m),
		(float)eye->pixel_rad);
}

static void set_all(const struct web_light *light, const struct view_draw_job *job,
	unsigned seen)
{
	glUseProgram(light->program);
	web_program_texture(light->program, "u_seen", 0, seen);
	web_program_texture(light->program, "u_plants", 1, light->plants.texture);
	web_program_texture(light->program, "u_shade", 2, light->shade);
	set_frame(light, job);
	set_octaves(light, job);
	set_rays(light, job->eye);
	if (job->selection->image.count)
		set_image(&light->image, light->program, 3, &job->selection->image, job->eye);
	if (web_shadow_wanted(&light->shadow, job->selection))
		web_shadow_set(&light->shadow, light->program, 5, job->eye->at);
}

enum eco_code web_light_draw(struct web_light *light, struct view_gl *gl, const struct view_draw_job *job,
	uint32_t width, uint32_t height, struct eco_error *error)
{
	bool shadows = web_shadow_wanted(&light->shadow, job->selection);
	uint32_t sample = job->eye->sample;
	enum eco_code code = web_light_prepare(light, job->selection->image.count > 0, shadows, error);
	if (!code && shadows && !sample && !light->shadow.keeps)
		code = web_shadow_draw(&light->shadow, gl, job, (const uint32_t[2]){ width, height }, error);
	if (!code)
		code = upload_selection(light, job, error);
	if (!code)
		code = upload_shade(light, job, error);
	if (code)
		return code;
	resize(&light->lit, width, height);
	if (sample == 1)
		web_mean_first(&light->mean, &light->lit);
	set_all(light, job, view_gl_target(gl, sample));
	glBindFramebuffer(GL_FRAMEBUFFER, light->lit.framebuffer);
	web_program_fill(light->lit.vertex_array, (const int[4]){ 0, 0, (int)width, (int)height });
	if (sample)
		web_mean_add(&light->mean, &light->lit, sample + 1);
	return ECO_OK;
}

void web_light_present(const struct web_light *light, const struct view_gl *gl, const struct web_place *place)
{
	glUseProgram(light->present);
	web_program_texture(light->present, "u_lit", 0, light->lit.texture);
	web_program_texture(light->present, "u_seen", 1, view_gl_target(gl, 0));
	glUniform4f(glGetUniformLocation(light->present, "u_depth"), place->depth[0], place->depth[1],
		place->sky, place->ground);
	glEnable(GL_DEPTH_TEST);
	glDepthFunc(GL_LEQUAL);
	web_program_fill(light->lit.vertex_array, place->viewport);
}

enum eco_code web_light_read(const struct web_light *light, uint8_t *rgb, struct eco_error *error)
{
	const struct web_lit *lit = &light->lit;
	size_t count = (size_t)lit->width * lit->height;
	uint8_t *rgba = malloc(count * 4);
	if (!rgba)
		return eco_no_memory(error, "the colours of a picture");
	glBindFramebuffer(GL_FRAMEBUFFER, lit->framebuffer);
	glReadPixels(0, 0, (GLsizei)lit->width, (GLsizei)lit->height, GL_RGBA, GL_UNSIGNED_BYTE, rgba);
	for (size_t i = 0; i < count; i++)
		memcpy(rgb + 3 * i, rgba + 4 * i, 3);
	free(rgba);
	return ECO_OK;
}
