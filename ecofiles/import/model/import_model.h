/* Inside the model importer: what its files share. Not for others.
 *
 *   eco_model_file_check     what the file is at all: empty, packed, of another kind (import_file.c)
 *   eco_FORMAT_read          a soup, in the file's axes and units unless the format says which they are
 *   (the above in a child process, one per file)
 *   eco_model_join           soups of several files become one, turned (import_join.c)
 *   eco_model_clean          useless triangles, rules about parts, foot, height (model_clean.c, model_parts.c, model_stand.c) */
#ifndef ECO_IMPORT_MODEL_H
#define ECO_IMPORT_MODEL_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "ecofiles/import/model/model_import.h"

#define ECO_MODEL_IMAGES_MAX 1024u
#define ECO_MODEL_MATERIALS_MAX (1u << 20)
#define ECO_MODEL_PARTS_MAX (1u << 20)
#define ECO_MODEL_FILE_MAX ((uint64_t)1 << 32)

struct eco_gltf;

/* Sentences for the user that are not errors, one a line; what does not fit is left out. */
struct eco_notes {
	char text[4096];
	size_t used;
};
void eco_note(struct eco_notes *notes, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* What a file says of the numbers in it. Positions are Z up where `up` is known (turned already), else as in the file. */
struct eco_model_frame {
	char format[64];             /* for people */
	double base[3];              /* place = base + position: what is far from the origin is brought near before it is rounded to floats */
	double unit_m;               /* metres per unit; 0: the file does not say */
	enum eco_up up;              /* axis of the file that points up; ECO_UP_FOUND: the file does not say */
	enum eco_up convention;      /* Y or Z: what files of that format mean as a rule */
};

/* A model file as assimp shall see it. */
struct eco_model_file {
	const char *path;
	bool linear_colors;          /* material colours are linear */
	uint8_t *bytes;              /* instead of the file's own, malloc'ed; NULL: as on disk */
	size_t size_bytes;
};

/* ---- Files (import_file.c) ---- */

/* Refuses by name what is no model: folders, empty, packed, pointers of Git LFS, scenes of editors, point clouds; says what
 * to do. ECO_OK: worth trying. */
enum eco_code eco_model_file_check(const char *path, struct eco_error *error);

/* The whole file, followed by a 0 that *size does not count; malloc'ed. At most `most` bytes. */
enum eco_code eco_file_read(const char *path, uint64_t most, uint8_t **bytes, size_t *size, struct eco_error *error);

/* Its first 64 KiB, followed by a 0; malloc'ed, NULL when memory ran out. A file that cannot be read has 0 bytes. */
char *eco_file_read_head(const char *path, size_t *size);

/* Refuses what no reader can read, from a file's first bytes (followed by a 0): empty, packed (zip unless the format is one itself),
 * pointers of Git LFS, web pages. `wanted`: "a model". */
enum eco_code eco_file_check_head(const char *path, const char *head, size_t size, bool holds_zip, const char *wanted, struct eco_error *error);

/* Whether a word is among the first `bytes` (at most 64 KiB) of a file, binary or not. */
bool eco_file_head_has(const char *path, size_t bytes, const char *word);

bool eco_path_ends_with(const char *path, const char *extension);

/* The last part of a path, in any system's spelling. */
const char *eco_path_last(const char *path);

/* A file that a model names (a texture, a library of materials): as named beside the model, else by its last part, whatever the case
 * of its letters; names of other systems and percent-escapes are understood. False if it is not there. */
bool eco_model_find_beside(const char *model, const char *name, char *path, size_t size);

/* ---- Readers ---- */

/* glTF 2.0 and GLB: what stands in the scene that a viewer would show, instances too, at rest. What files require and is not read is
 * refused by name. */
enum eco_code eco_gltf_read_model(struct eco_model *model, struct eco_model_frame *frame, const char *path, uint32_t triangles_max,
	struct eco_notes *notes, struct eco_error *error);
/* The same of a document that is open (gltf.h). On failure *model holds what there was so far: free it. */
enum eco_code eco_gltf_read_document(struct eco_model *model, struct eco_model_frame *frame, struct eco_gltf *doc, uint32_t triangles_max,
	struct eco_notes *notes, struct eco_error *error);

/* OBJ with MTL: positions, uv from the top left, materials, parts and images; triangles_in counts. Not cleaned. */
enum eco_code eco_obj_read(struct eco_model *model, struct eco_model_frame *frame, const char *path, uint32_t triangles_max,
	struct eco_notes *notes, struct eco_error *error);

/* PLY for assimp: a file with coordinates in double precision far from the origin becomes one near it (file->bytes, *base what was
 * taken away); others stay as they are. Refuses what has no faces. */
enum eco_code eco_ply_prepare(struct eco_model_file *file, double base[3], struct eco_error *error);

/* What to take away from coordinates between low and high so that floats hold them: 0 unless they are far from the origin for their
 * extent. Whole numbers. */
void eco_model_choose_base(const double low[3], const double high[3], double base[3]);

/* ---- Images (import_image.c) ---- */

enum eco_alpha { ECO_ALPHA_BY_IMAGE, ECO_ALPHA_OPAQUE, ECO_ALPHA_MASK };

struct eco_image_wanted {
	const char *texture, *opacity;       /* as the material names them; opacity NULL: none */
	enum eco_alpha alpha;
	float gain;                          /* alpha is multiplied by this: 128 is the threshold afterwards */
};

struct eco_image_key;

/* The images of a model while it is read: one for each texture and alpha rule. */
struct eco_images {
	struct eco_model *model;
	const char *path;                    /* of the model: textures are looked for beside it */
	struct eco_notes *notes;
	/* A texture inside the model: false if `name` is none; else *code tells. NULL: there are none. */
	bool (*embedded)(void *ctx, const char *name, struct eco_image *image, enum eco_code *code, struct eco_error *error);
	void *ctx;
	struct eco_image_key *keys;          /* per image of the model */
	uint64_t pixels;
};

/* model->images has none before. False when memory ran out. */
bool eco_images_start(struct eco_images *images);
/* Index of the image, decoded, with alpha 255 all over unless some of it is cut out, else with 128 as the threshold; ECO_NONE where it
 * cannot be had, which is noted once. */
uint32_t eco_images_get(struct eco_images *images, const struct eco_image_wanted *wanted, bool *cutout);
/* Frees what was needed on the way; images that could not be had vanish, and the model's materials name the others. */
void eco_images_end(struct eco_images *images);

/* ---- Materials and colours ---- */

/* A plant whose every material is fully transparent was meant to be opaque: exporters disagree whether 0 or 1 is that. Clears
 * `invisible` and notes it where it is set for all `count`. */
void eco_model_see_invisible(bool *invisible, uint32_t count, struct eco_notes *notes);

/* A material whose picture cannot be had: what is left is what the picture was multiplied with. Unless that has a hue, it is no colour. */
void eco_material_lost_picture(struct eco_material *material);

/* A plant that is one light grey all over has no colour: the grey is what a program takes for a surface that nobody coloured. */
void eco_model_see_grey(struct eco_model *model);

/* Materials made of vertex colours: grown from the model's, which have room for ECO_TINTS_MAX more. */
#define ECO_TINTS_MAX 4096u
struct eco_tints {
	struct eco_model *model;
	uint32_t base, count;        /* those of the model before; further ones */
	uint64_t *key;
	uint32_t *table;             /* open addressing: tint + 1 */
};
bool eco_tints_start(struct eco_tints *tints, struct eco_model *model);
/* Material `material` times an sRGB colour, in linear light; white changes nothing, nor does one tint too many. */
uint32_t eco_tints_get(struct eco_tints *tints, uint32_t material, const uint8_t rgb[3]);
/* A colour in the eight steps a channel that are kept of vertex colours where they differ within a mesh. */
void eco_tint_step(uint8_t rgb[3]);
void eco_tints_end(struct eco_tints *tints);

/* Multiplies images by the colours of their materials, which become white; equal images become one. Materials may name the images of
 * the model only, at most ECO_MODEL_IMAGES_MAX of them, or none. Fails only for lack of memory. */
enum eco_code eco_model_bake_tints(struct eco_model *model, const char *path, struct eco_notes *notes, struct eco_error *error);

uint8_t eco_srgb_from_linear(double linear);
double eco_linear_from_srgb(uint8_t srgb);

/* ---- Several files (import_join.c) ---- */

struct eco_model_piece {         /* a file as its reader left it */
	struct eco_model model;
	struct eco_model_frame frame;
	const char *path;
};

/* Makes one soup of the pieces, which become empty: Z up, in the unit of the first file, parts named after their files where there are
 * several. What formats do not say of the axes comes from `options`, from another piece, or from the shape, which is noted. `frame`
 * receives base, unit and up of the whole. */
enum eco_code eco_model_join(struct eco_model *model, struct eco_model_frame *frame, struct eco_model_piece *pieces, uint32_t count,
	const struct eco_model_options *options, struct eco_notes *notes, struct eco_error *error);

#endif
