#include "client-min/web/web_light.h"

#include <GLES3/gl3.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/draw/view_gpu.h"
#include "client-min/draw/view_light.h"
#include "client-min/draw/view_shadow.h"
#include "client-min/view_record.h"
#include "client-min/web/web_program.h"
#include "ecofiles/base/array_grow.h"

#define PLANT_TEXELS 3
#define TEXT(macro) TEXT_OF(macro)
#define TEXT_OF(value) #value
#define BLOCK 1024u                      /* texels of the coarsest level of a tile of the ground's image */

static const char light_text[] =
#include "build/text/client-min/web/web_light.glsl"
	;
static const char present_text[] =
#include "build/text/client-min/web/web_present.glsl"
	;

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

enum eco_code web_light_prepare(struct web_light *light, unsigned image, bool shadows, struct eco_error *error)
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
		*program = web_program(light_text, (const char *const[]){ metre, image == 2 ? "#define IMAGE\n#define WATER\n#define ECO_GROUND_WATER " TEXT(ECO_GROUND_WATER) ".0\n"
			: image ? "#define IMAGE\n" : "",
			shadows ? "#define SHADOW\n" VIEW_SHADOW_DEPTH : "", light_text }, 4, "light", error);
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
	for (int i = 0; i < 6; i++)
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
	enum eco_code code = web_light_prepare(light, !job->selection->image.count ? 0
		: view_store_needs(job->store) & ECO_NEED_WATER ? 2 : 1, shadows, error);
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
	glUniform1ui(glGetUniformLocation(light->present, "u_marked"), place->marked);
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
