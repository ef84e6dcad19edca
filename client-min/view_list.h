/* One list as a client holds it: a prefix of its chunks, decoded. It grows and shrinks at its end, chunk by
 * chunk, and never moves its meaning: primitive i stays primitive i.
 *
 *   view_piece_decode(&piece, list, &chunk, ordinal, payload, images, &error);
 *   view_list_push(list, &piece, &chunk, &error);           the piece becomes chunk list->chunk_count
 *   view_list_pop(list);                                    the last chunk goes, and its memory with it
 *   view_piece_free(&piece);                                in any case */
#pragma once

#include "ecofiles/format/chunk/chunk.h"
#include "ecofiles/format/ground_tile.h"
#include "ecofiles/format/image.h"
#include "ecofiles/format/pack.h"
#include "ecofiles/format/texture.h"
#include "lod/impostor.h"
#include "lod/tint.h"

/* Chunks end here; geometry of a chunk can be made without walking the list. The first three are exclusive
 * running totals. */
struct view_mark {
	uint32_t primitives, elements, corners;
	uint32_t rows;                   /* of texels, of this chunk alone */
	uint32_t bytes;                  /* decoded, of this chunk alone */
	uint64_t used;                   /* when a plan last needed it (view_cache.h): never more than of the
	                                  * chunk before it, as plans need prefixes */
};

struct view_list {                       /* stays where it is until its last chunk has gone */
	uint32_t id;
	struct eco_list list;            /* as the stream described it */
	uint8_t (*palette)[3];           /* list.palette_count colours, sRGB */
	struct eco_group *groups;        /* list.group_count */
	uint32_t chunk_count;            /* chunks held: a prefix */
	uint32_t served;                 /* chunks that the server believes to be held: at least those */
	struct view_mark *marks;         /* one per chunk; those served are set */
	struct eco_elements elements;    /* of all chunks held, in draw order */
	uint64_t bytes;                  /* held in all: this struct and what it owns */
	struct eco_texture_part *parts;  /* eco_list_has_texels: one for each level */
	/* IMAGE: as the plan shows it, and the number of levels, and of the outline's, that this is of */
	struct eco_image image;
	uint32_t shown[2];
	bool cutout;                     /* the image has clear texels */
	struct lod_impostor *impostors;  /* lists of kind IMPOSTOR: one for each chunk held */
	/* lists of kind GROUND, once their chunk is here: level, column and row */
	struct eco_ground_tile tile;
};

/* How much of a colour of its palette, or of an impostor, is wood. */
static inline struct lod_tint_wood view_list_wood(const struct view_list *list)
{
	static const uint8_t none[3];
	bool told = eco_list_is_mixed(&list->list) && list->list.wood;
	return lod_tint_wood(told ? list->list.wood : 0, told ? list->palette[list->list.palette_count - 1] : none);
}

/* Memory of a list that is described and holds nothing. */
uint64_t view_list_bytes(const struct eco_list *list);
/* `palette` and `groups` are copied. NULL: no memory. */
struct view_list *view_list_new(uint32_t id, const struct eco_list *list, const uint8_t (*palette)[3],
	const struct eco_group *groups);
void view_list_free(struct view_list *list);                     /* NULL is fine */

struct view_piece {                      /* a decoded chunk that no list owns yet; zero is empty */
	struct eco_elements elements;
	struct eco_texture_part part;
	struct lod_impostor impostor;
	struct eco_ground_tile tile;
	uint64_t bytes;                  /* decoded */
};

struct view_piece_input {
	const struct view_list *list;
	const struct eco_chunk *chunk;
	uint32_t ordinal;
	const uint8_t *payload;
	bool images;                     /* false: the payload of an IMAGE is dropped */
	const struct eco_scene *scene;   /* whose ground it may be */
};
/* Decodes and checks all that users of decoded elements rely on: colours lie in the palette, codes exist,
 * samples of the ground are in their places. */
enum eco_code view_piece_decode(struct view_piece *piece, const struct view_piece_input *input,
	struct eco_error *error);
void view_piece_free(struct view_piece *piece);

/* Adds piece->bytes to list->bytes. Ordinals, marks but this one's `used`, and what the piece held are the
 * list's afterwards. */
enum eco_code view_list_push(struct view_list *list, struct view_piece *piece, const struct eco_chunk *chunk,
	struct eco_error *error);
/* Makes list->image what a list of kind IMAGE shows in `levels` levels, cut out by as many of `outline` as
 * outline_levels says (NULL: it is opaque); it is empty where these are not held. Its memory has been counted
 * with its parts. */
enum eco_code view_list_show(struct view_list *list, uint32_t levels, const struct view_list *outline,
	uint32_t outline_levels, struct eco_error *error);
void view_list_pop(struct view_list *list);
/* Sets the running totals of chunk `ordinal`, all marks before it being set, without holding it. */
void view_list_mark(struct view_list *list, uint32_t ordinal, const struct eco_chunk *chunk, uint64_t bytes);
struct view_mark view_list_before(const struct view_list *list, uint32_t ordinal);

/* Elements of chunks [first, end) as a view into the list's arrays: nothing is copied, nothing to free. */
struct eco_elements view_list_chunks(const struct view_list *list, uint32_t first, uint32_t end);
