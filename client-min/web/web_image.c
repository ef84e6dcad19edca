#include "client-min/web/web_image.h"

#include <GLES3/gl3.h>
#include <stdlib.h>
#include <string.h>

#include "client-min/web/web_program.h"
#include "ecofiles/base/array_grow.h"

#define BLOCK 1024u                      /* texels of the coarsest level of a tile */

/* ---- Texels ---- */

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

static void forget(struct web_image *image)
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
	forget(image);
	return view_gpu_room(gpu, &image->texels, VIEW_GPU_COLOR, count_blocks(image, of, true) * BLOCK, error);
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

/* ---- The tree ---- */

static enum eco_code upload_tree(struct web_image *image, struct view_gpu *gpu, const struct view_image *of,
	struct eco_error *error)
{
	size_t count = of->node_count + (size_t)of->count * ECO_GROUND_IMAGE_LEVELS;
	uint32_t *words = malloc(count * sizeof *words);
	if (!words)
		return eco_no_memory(error, "the image of the ground");
	memcpy(words, of->nodes, of->node_count * sizeof *words);
	for (uint32_t i = 0; i < of->count; i++)
		memcpy(words + of->node_count + i * ECO_GROUND_IMAGE_LEVELS, find(image, &of->tiles[i])->block,
			ECO_GROUND_IMAGE_LEVELS * sizeof *words);
	enum eco_code code = view_gpu_stream(gpu, &image->nodes, VIEW_GPU_WORD, words, count, error);
	free(words);
	image->node_count = of->node_count;
	return code;
}

enum eco_code web_image_upload(struct web_image *image, struct view_gpu *gpu, const struct view_image *of,
	struct eco_error *error)
{
	enum eco_code code = make_room(image, gpu, of, error);
	for (uint32_t i = 0; i < of->count && !code; i++)
		code = upload_tile(image, &of->tiles[i], error);
	return code ? code : upload_tree(image, gpu, of, error);
}

void web_image_free(struct web_image *image)
{
	const unsigned textures[] = { image->nodes.texture, image->texels.texture };
	glDeleteTextures(2, textures);
	forget(image);
	*image = (struct web_image){ 0 };
}

/* ---- In shaders ---- */

const char web_image_text[] = "#define wide float\n"
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

void web_image_set(const struct web_image *image, unsigned program, int unit, const struct view_image *of,
	const struct lod_eye *eye)
{
	web_program_texture(program, "u_nodes", unit, image->nodes.texture);
	web_program_texture(program, "u_texels", unit + 1, image->texels.texture);
	glUniform3i(glGetUniformLocation(program, "u_tree"), (int)image->nodes.shift, (int)image->texels.shift,
		(int)image->node_count);
	glUniform4f(glGetUniformLocation(program, "u_image"),
		(float)((eye->at[0] - of->origin[0]) / of->side_m),
		(float)((eye->at[1] - of->origin[1]) / of->side_m), (float)(1 / of->side_m),
		(float)eye->pixel_rad);
}
