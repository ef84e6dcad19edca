/* Keys of finished plants: a hash of the model, of the options and of the program itself, so that nobody
 * has to remember to raise a version. The model is hashed as it was read, not its files: their places and
 * times do not matter, while a texture or a rule that changes the model does. */
#include "ecofiles/ecopack/make.h"

#include <elf.h>
#include <link.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <xxhash.h>

#include "ecofiles/base/bytes.h"
#include "ecofiles/ecopack/run.h"
#include "lod/build/plant.h"

/* ---- The program ---- */

/* Hashes a library's build id, as results may change with the library. One without an id counts by its
 * name, which has a version. */
static int add_library(struct dl_phdr_info *info, size_t size, void *ctx)
{
	(void)size;
	bool found = false;
	for (int i = 0; i < info->dlpi_phnum; i++) {
		const ElfW(Phdr) *header = &info->dlpi_phdr[i];
		if (header->p_type != PT_NOTE)
			continue;
		struct eco_reader r = { (const uint8_t *)info->dlpi_addr + header->p_vaddr, header->p_memsz,
			0, false };
		while (!r.failed && r.at < r.size) {
			uint32_t name = eco_read_u32(&r), length = eco_read_u32(&r), type = eco_read_u32(&r);
			eco_read_bytes(&r, (name + 3) & ~3u);
			const uint8_t *note = eco_read_bytes(&r, (length + 3) & ~3u);
			if (note && type == NT_GNU_BUILD_ID && name == 4) {
				XXH3_128bits_update(ctx, note, length);
				found = true;
			}
		}
	}
	if (!found)
		XXH3_128bits_update(ctx, info->dlpi_name, strlen(info->dlpi_name) + 1);
	return 0;
}

/* Hashes the program's own file: it has a build id only if the linker was asked for one. */
static bool add_program(XXH3_state_t *hash)
{
	FILE *file = fopen("/proc/self/exe", "rbe");
	static const size_t room = 1u << 16;
	uint8_t *bytes = malloc(room);
	bool ok = file && bytes;
	for (size_t got; ok && (got = fread(bytes, 1, room, file)) > 0;)
		XXH3_128bits_update(hash, bytes, got);
	ok = ok && !ferror(file);
	if (file)
		fclose(file);
	free(bytes);
	dl_iterate_phdr(add_library, hash);
	return ok;
}

static struct { XXH128_hash_t hash; bool known; } program;
static pthread_once_t program_once = PTHREAD_ONCE_INIT;

static void find_program(void)
{
	XXH3_state_t *hash = XXH3_createState();
	if (hash) {
		XXH3_128bits_reset(hash);
		program.known = add_program(hash);
		program.hash = XXH3_128bits_digest(hash);
	}
	XXH3_freeState(hash);
}

void make_cache_begin(void) { pthread_once(&program_once, find_program); }

/* ---- The model and the options ---- */

static void add(XXH3_state_t *hash, const void *bytes, size_t size)
{
	uint64_t length = bytes ? size : UINT64_MAX;
	XXH3_128bits_update(hash, &length, sizeof length);
	if (bytes && size)
		XXH3_128bits_update(hash, bytes, size);
}

#define ADD(hash, value) add(hash, &(value), sizeof(value))

static void add_model(XXH3_state_t *hash, const struct eco_model *model)
{
	size_t vertices = model->vertex_count, triangles = model->triangle_count;
	add(hash, model->position, 3 * vertices * sizeof *model->position);
	add(hash, model->uv, 2 * vertices * sizeof *model->uv);
	add(hash, model->index, 3 * triangles * sizeof *model->index);
	add(hash, model->material, triangles * sizeof *model->material);
	add(hash, model->part, triangles * sizeof *model->part);
	add(hash, model->organ, triangles * sizeof *model->organ);
	add(hash, model->importance, triangles);
	add(hash, model->importances, model->importance_count * sizeof *model->importances);
	ADD(hash, model->dropped);
	for (uint32_t i = 0; i < model->material_count; i++) {
		const struct eco_material *m = &model->materials[i];
		const uint8_t flags[] = { m->cutout, m->colourless };
		add(hash, m->name, strlen(m->name));
		ADD(hash, m->rgb);
		ADD(hash, flags);
		ADD(hash, m->image);
	}
	for (uint32_t i = 0; i < model->image_count; i++) {
		const struct eco_image *image = &model->images[i];
		ADD(hash, image->width);
		ADD(hash, image->height);
		add(hash, image->rgba, 4 * (size_t)image->width * image->height);
	}
	for (uint32_t i = 0; i < model->part_count; i++)
		add(hash, model->parts[i].name, strlen(model->parts[i].name));
}

/* Hashes the options except the name, which the plant gets afterwards, and the progress callback. */
static void add_options(XXH3_state_t *hash, const struct lod_plant_options *options)
{
	const uint32_t numbers[] = { options->seed, (uint32_t)options->order, options->cell_triangles,
		options->grid_bits, options->views, options->pixels, options->draft };
	ADD(hash, numbers);
	ADD(hash, options->importance);
}

/* False if the program's file cannot be read; else *hash has the program. */
static bool key_begin(XXH3_state_t **hash)
{
	*hash = XXH3_createState();
	make_cache_begin();
	if (!*hash || !program.known)
		return false;
	XXH3_128bits_reset(*hash);
	ADD(*hash, program.hash.low64);
	ADD(*hash, program.hash.high64);
	return true;
}

static void key_end(struct main_cache_key *key, const XXH3_state_t *hash)
{
	XXH128_canonical_t canonical;
	XXH128_canonicalFromHash(&canonical, XXH3_128bits_digest(hash));
	memcpy(key->bytes, canonical.digest, sizeof key->bytes);
}

bool make_cache_bytes_key(struct main_cache_key *key, const char *what, const void *bytes, size_t size)
{
	XXH3_state_t *hash;
	bool ok = key_begin(&hash);
	if (ok) {
		add(hash, what, strlen(what));
		add(hash, bytes, size);
		key_end(key, hash);
	}
	XXH3_freeState(hash);
	return ok;
}

/* ---- Plants ---- */

bool make_cache_key(struct main_cache_key *key, const struct eco_model *model,
	const struct lod_plant_options *options)
{
	XXH3_state_t *hash;
	bool ok = key_begin(&hash);
	if (ok) {
		add_model(hash, model);
		add_options(hash, options);
		key_end(key, hash);
	}
	XXH3_freeState(hash);
	return ok;
}

static bool names_images(const struct lod_plant *plant, const struct eco_model *model)
{
	for (uint32_t i = 0; i < plant->image_count; i++)
		if (plant->images[i] >= model->image_count)
			return false;
	return true;
}

bool make_cache_get(struct main_cache *cache, const struct main_cache_key *key, const struct eco_model *model,
	const char *name, struct lod_plant *plant)
{
	struct eco_error error = { 0 };
	uint8_t *bytes;
	size_t size;
	if (!main_cache_get(cache, key, &bytes, &size))
		return false;
	enum eco_code code = lod_plant_read(plant, bytes, size, &error);
	free(bytes);
	if (!code && !names_images(plant, model)) {
		lod_plant_free(plant);
		code = eco_fail(&error, ECO_DAMAGED, "textures that the model has not");
	}
	if (code)
		main_cache_reject(cache, key, error.text);
	else
		strncpy(plant->plant.name, name, sizeof plant->plant.name - 1);
	return !code;
}

void make_cache_put(struct main_cache *cache, const struct main_cache_key *key, const struct lod_plant *plant)
{
	struct eco_writer writer = { 0 };
	lod_plant_write(&writer, plant);
	if (!writer.failed)
		main_cache_put(cache, key, writer.bytes, writer.size);
	eco_writer_free(&writer);
}
