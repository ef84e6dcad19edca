/* Shared by the files of the model importer; private.
 *
 *   eco_model_file_check     the kind of file: empty, packed, not a model (import_file.c)
 *   eco_FORMAT_read          a soup, in the file's axes and units unless the format states them
 *   (the above in a child process, one per file)
 *   eco_model_clean          triangles, rules, foot, height (model_clean.c, model_parts.c, model_stand.c) */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "ecofiles/import/model/import_file.h"
#include "ecofiles/import/model/model_import.h"

#define ECO_MODEL_IMAGES_MAX 1024u
#define ECO_MODEL_MATERIALS_MAX (1u << 20)
#define ECO_MODEL_PARTS_MAX (1u << 20)
#define ECO_MODEL_FILE_MAX ((uint64_t)1 << 32)

/* The frame of a file's numbers. Positions are Z up if `up` is known (turned already), else as in the
 * file. */
struct eco_model_frame {
	char format[64];             /* for messages */
	double base[3];              /* place = base + position: keeps floats exact far from the origin */
	double unit_m;               /* metres per unit; 0: not stated */
	enum eco_up up;              /* axis of the file that points up; ECO_UP_FOUND: not stated */
	enum eco_up convention;      /* Y or Z: usual in files of that format */
};

/* ---- Files (import_file.c) ---- */

/* Refuses files that are no models by name: folders, empty or packed files, pointers of Git LFS, scenes of
 * editors, point clouds; the error says what to do. ECO_OK: worth trying. */
enum eco_code eco_model_file_check(const char *path, struct eco_error *error);

/* Finds a file that a model names (a texture, a library of materials): as named, beside the model; else by
 * its last part, in any case. Understands other systems' paths and percent-escapes. False: not found. */
bool eco_model_find_beside(const char *model, const char *name, char *path, size_t size);

/* ---- Readers ---- */

/* Makes the arrays of vertices and triangles, with a bit to spare: all is 0. */
void eco_model_reserve(struct eco_model *model, uint64_t vertices, uint64_t triangles);

/* A hash table for `entries` numbers by open addressing; free slots are ECO_NONE. */
uint32_t *model_table_new(uint64_t entries, uint32_t *mask);

/* glTF 2.0 and GLB: the scene that a viewer would show, with instances, at rest. Refuses by name required
 * extensions that are not read. */
enum eco_code eco_gltf_read_model(struct eco_model *model, struct eco_model_frame *frame, const char *path,
	uint32_t triangles_max, struct eco_notes *notes, struct eco_error *error);
/* OBJ with MTL: positions, uv from the top left, materials, parts, images, triangles_in. Not cleaned. */
enum eco_code eco_obj_read(struct eco_model *model, struct eco_model_frame *frame, const char *path,
	uint32_t triangles_max, struct eco_notes *notes, struct eco_error *error);

struct eco_bounds { double low[3], high[3]; };
#define ECO_NO_BOUNDS { { INFINITY, INFINITY, INFINITY }, { -INFINITY, -INFINITY, -INFINITY } }
/* A place that is not finite does not count. */
void eco_bounds_add(struct eco_bounds *bounds, const double place[3]);

/* ---- A soup while it is read (model_soup.c) ---- */

/* Begins with the first four fields and zeros; free it in any case. A reader adds meshes, each with its
 * vertices and triangles, and bounds their numbers. Materials must be there at the end. */
struct eco_soup_vertex { double place[3]; float uv[2], rgb[3]; };
struct eco_soup_triangle { uint32_t v[3], part; };
struct eco_soup_mesh { uint32_t triangle, material; bool colored; };
struct eco_soup {
	struct eco_model *model;
	struct eco_model_frame *frame;       /* its base is set at the end */
	struct eco_notes *notes;
	bool linear;                         /* colours of vertices are linear light; else sRGB */
	const bool *invisible;               /* per material; at the end */
	double far;                          /* greatest coordinate that the file holds in single precision */
	uint32_t part, part_room;            /* of the triangles that come */
	struct eco_soup_vertex *vertices;    uint32_t vertex_count, vertex_room;
	struct eco_soup_triangle *triangles; uint32_t triangle_count, triangle_room;
	struct eco_soup_mesh *meshes;        uint32_t mesh_count, mesh_room;
	double *corners;                     /* of one polygon */
	uint32_t *split;
};
/* Adds the part NODE, MESH or NODE/MESH, unless it is the last one: some programs show one name, some the
 * other. */
void eco_soup_part(struct eco_soup *soup, const char *node, size_t node_bytes, const char *mesh,
	size_t mesh_bytes);
/* Triangles to come have this material; `colored`: times the colours of their vertices. */
void eco_soup_mesh(struct eco_soup *soup, uint32_t material, bool colored);
/* uv, rgb NULL: 0. Returns its number. */
uint32_t eco_soup_vertex(struct eco_soup *soup, const double place[3], const float uv[2], const float rgb[3]);
/* ECO_NONE: a missing vertex. */
void eco_soup_triangle(struct eco_soup *soup, uint32_t a, uint32_t b, uint32_t c);
/* Room for a polygon of up to ECO_POLYGON_CORNERS_MAX (geometry.h) corners, 3 coordinates each; then its n -
 * 2 triangles, as numbers of corners. One with a corner that is not finite has no shape: a fan keeps its
 * count of triangles, and the bad ones are dropped later. */
double *eco_soup_corners(struct eco_soup *soup);
const uint32_t *eco_soup_split(struct eco_soup *soup, uint32_t n);
/* `fields` of the file say what is transparent, for a note. */
void eco_soup_end(struct eco_soup *soup, const char *fields);
void eco_soup_free(struct eco_soup *soup);

/* ---- Images (import_material.c) ---- */

enum eco_alpha { ECO_ALPHA_BY_IMAGE, ECO_ALPHA_OPAQUE, ECO_ALPHA_MASK };

struct eco_image_wanted {
	const char *texture, *opacity;       /* as in the material; NULL: none */
	enum eco_alpha alpha;
	float gain;                          /* factor of alpha, after which 128 is the threshold */
};

struct eco_image_key;

/* The images of a model while it is read: one for each texture and alpha rule. */
struct eco_images {
	struct eco_model *model;
	const char *path;                    /* of the model: textures are looked for beside it */
	struct eco_notes *notes;
	/* Reads a texture inside the model: false if `name` is none of them; else sets *code. NULL: there
	 * are none. */
	bool (*embedded)(void *ctx, const char *name, struct eco_image *image, enum eco_code *code,
		struct eco_error *error);
	void *ctx;
	struct eco_image_key *keys;          /* per image of the model */
	uint64_t pixels;
};

/* model->images must be empty. False when memory ran out. */
void eco_images_start(struct eco_images *images);
/* Frees working memory; drops images that could not be read, and renumbers the materials' images. */
void eco_images_end(struct eco_images *images);

/* Image as[i] stands for image i from now on: i itself, an earlier one, or ECO_NONE. Frees the images
 * that are replaced and renumbers those of materials. At most ECO_MODEL_IMAGES_MAX images. */
void eco_images_keep(struct eco_model *model, const uint32_t *as);

/* ---- Materials and colours ---- */

/* If all `count` materials are fully transparent, they were meant to be opaque: exporters disagree whether
 * 0 or 1 is opaque. Then clears `invisible` and notes it. */
void eco_model_see_invisible(bool *invisible, uint32_t count, struct eco_notes *notes);

/* Gives a material its picture. `replaces`: it is drawn instead of the material's colour, whatever exporters
 * leave there (0.8, 0.64, 0); else times it. A picture that cannot be read leaves only the factor, which
 * counts as a colour only if it has a hue. */
void eco_material_take_picture(struct eco_material *material, struct eco_images *images,
	const struct eco_image_wanted *wanted, bool replaces);

/* A plant of one light grey all over, or of programs' default greys, has no colour: programs use them for
 * surfaces that nobody coloured. Nor has one of all shades of red or blue and no other colour: games keep
 * weights of wind there. */
void eco_model_see_colourless(struct eco_model *model, struct eco_notes *notes);

/* Materials may get so many more, made from vertex colours. */
#define ECO_TINTS_MAX 4096u
/* Rounds a colour to eight steps a channel, which is used where vertex colours differ within a mesh. */
void eco_tint_step(uint8_t rgb[3]);

/* A picture whose triangles show one colour each becomes colours of materials, and is dropped. */
void eco_model_take_palettes(struct eco_model *model);

/* Multiplies images by the colours of their materials, which become white, and merges equal images.
 * Materials may only name the model's images, at most ECO_MODEL_IMAGES_MAX of them, or none. */
void eco_model_bake_tints(struct eco_model *model, struct eco_notes *notes);

uint8_t eco_srgb_from_linear(double linear);
uint8_t eco_byte_from_share(double share);       /* 0 to 1; NaN is 0 */
/* Whether a material with this alpha is drawn. */
bool eco_alpha_shows(double alpha);
double eco_linear_from_srgb(uint8_t srgb);
