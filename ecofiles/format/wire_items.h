/* The items of a BUNDLE's directory, one after the other in one range-coded stream (ecofiles/base/range.h):
 * plants, lists and chunks; most are nearly as those before them. Models learned in one bundle
 * serve the next ones of the stream; where the range coder is told to write, it writes.
 *
 *   struct eco_wire_items items;  eco_wire_items_start(&items);             once a stream
 *   eco_range_write(&range, &directory);                                    or eco_range_read; once a bundle
 *   eco_wire_item_code(&range, &items, &item);                              and the arrays of an item, each:
 *       PLANT: eco_wire_anchor_code;  LIST: eco_wire_group_code, then eco_wire_colour_code
 *   ... item.kind == ECO_ITEM_END ...
 *
 * Item: 2 bits, modelled by the kind of the item before: END 0, PLANT 1, LIST 2, CHUNK 3. Then
 *   PLANT  id - (last plant + 1), name: number of bytes, 8 bits each; height (real, against the last
 *          one's), anchor first - end of the last one's, anchor count; of more than 1 anchor: 1 bit,
 *          modelled: 0: the first follows, 1: all; leaf width (16 bits) and tone (8 bits); these anchors:
 *          x, y, z, radius (reals without `same`, against the anchor before)
 *   LIST   id - (last item's list + 1); kind: 4 bits, modelled by the last list's; coder (3 bits),
 *          attributes (8 bits), modelled by the kind; then the fields of enum eco_wire_field, each against
 *          the last list of the kind; the grid: 2 bits: 0: that of the last list of the kind, 1: of the
 *          last list, 2: origin and step (reals, against the last list of the kind; step 1 and 2: against
 *          the axis before); unit_area (a real, likewise). Groups: plant - (plant before + 1; first: first
 *          of the last list's groups), count - 1. Palette, nothing if its place in the scene's is that of
 *          the last palette sent: 3 * 8 bits a colour
 *   CHUNK  id - last item's list; but for the only chunk of a list, right behind its record: ordinal (1
 *          bit: it is the next of the list, or the first; else a number), elements (1 bit: those of the
 *          last chunk with this ordinal of a list of the kind; else a count), primitives - elements (2
 *          bits: 0: none, 1: as many as elements, 2: a number); named (1 bit), size (count), 16 bytes of id
 *          if it is named
 *
 * number   6 bits n, modelled, then the n - 1 bits below the highest
 * count    number of v / 2, then the lowest bit: so that no array grows on less than a bit
 * signed   number of the zigzag code, modulo 2^32
 * field    1 bit, modelled: 0: as in the list before; 1: a number (OWNER, PALETTE_FIRST: signed difference)
 * real     1 bit, modelled: 0: the same as what it is told by; else sign (1 bit), exponent less that of the
 *          other (signed), place of the lowest bit that is set less that of the other's (signed), and the
 *          bits between. So grids with few significant bits take few bits.
 * A field that is marked as different must differ, or is refused. */
#pragma once

#include "ecofiles/base/range.h"
#include "ecofiles/format/pack.h"

enum eco_wire_item_kind { ECO_ITEM_END, ECO_ITEM_PLANT, ECO_ITEM_LIST, ECO_ITEM_CHUNK, ECO_ITEM_KINDS };
enum eco_wire_field {
	ECO_FIELD_OWNER, ECO_FIELD_PALETTE_FIRST, ECO_FIELD_PALETTE_COUNT, ECO_FIELD_LEVEL, ECO_FIELD_GROUPS,
	/* image and partner less the list's own id, zigzag, and 1; 0: none */
	ECO_FIELD_IMAGE, ECO_FIELD_PARTNER,
	ECO_FIELD_COLUMNS, ECO_FIELD_CHUNKS, ECO_FIELD_ELEMENTS,         /* elements: a count, without `same` */
	ECO_FIELD_MORE, ECO_FIELDS                                       /* primitives - elements */
};
#define ECO_ITEM_LIST_KINDS 16u
#define ECO_GRID_REALS 6u                        /* of a list: origin, step; ... */
#define ECO_ITEM_REALS (ECO_GRID_REALS + 1)      /* ... and unit_area */
#define ECO_ITEM_ORDINALS 32u
#define ECO_NUMBER_MODELS 64u

struct eco_wire_number { struct eco_bit models[ECO_NUMBER_MODELS]; };
struct eco_wire_real { struct eco_bit same; struct eco_wire_number exponent, low; };

/* Context that codes a stream's next item; about 90 kB. */
struct eco_wire_items {
	struct eco_bit kinds[ECO_ITEM_KINDS][4], list_kind[ECO_ITEM_LIST_KINDS][16],
		coder[ECO_ITEM_LIST_KINDS][8], attributes[ECO_ITEM_LIST_KINDS][256],
		same[ECO_ITEM_LIST_KINDS][ECO_FIELDS], next, alike[ECO_ITEM_LIST_KINDS],
		more[ECO_ITEM_LIST_KINDS][4], grid[ECO_ITEM_LIST_KINDS][4], named, celled, letters[256];
	struct eco_wire_number fields[ECO_ITEM_LIST_KINDS][ECO_FIELDS], plant_step, list_step, chunk_step,
		letter_count, anchor_first, anchor_count, group_plant, group_count, ordinal, elements, extra,
		size[ECO_ITEM_LIST_KINDS];
	struct eco_wire_real reals[ECO_ITEM_LIST_KINDS][3], height, anchor[2];
	enum eco_wire_item_kind kind;            /* of the last item; then what it said */
	uint32_t plant, anchor_end, list, chunk_list, chunk_ordinal, described;
	uint32_t field[ECO_ITEM_LIST_KINDS][ECO_FIELDS], groups_plant, group;
	double real[ECO_ITEM_LIST_KINDS][ECO_ITEM_REALS], last_grid[ECO_GRID_REALS], last_height, last_anchor[4];
	uint8_t list_kind_last, chunk_kind;
	bool alone;                              /* the last item is a list of one chunk, ... */
	uint32_t alone_elements, alone_primitives;   /* ... which has all of these */
	uint32_t chunk_elements[ECO_ITEM_LIST_KINDS][ECO_ITEM_ORDINALS];
	uint32_t palette_first, palette_count;   /* where the last palette that was sent lies */
	bool bad;                                /* what was read is impossible, or said in vain */
};

struct eco_wire_item {
	enum eco_wire_item_kind kind;
	uint32_t id;                             /* of the plant; of the list, or the chunk's */
	struct eco_plant plant;                  /* name, height_m, anchor_first, anchor_count, leaf_* */
	bool cells;                              /* all anchors follow, not the whole plant's alone */
	struct eco_list list;                    /* chunk_first is 0 when it was read */
	uint32_t ordinal;
	struct eco_chunk chunk;                  /* counts and size; id if it is named */
	bool named;
};

void eco_wire_items_start(struct eco_wire_items *items);
/* Reading: see items->bad. Counts are what was said: see eco_wire_items_bits. */
void eco_wire_item_code(struct eco_range *range, struct eco_wire_items *items, struct eco_wire_item *item);
void eco_wire_anchor_code(struct eco_range *range, struct eco_wire_items *items, struct eco_anchor *anchor);
/* Number i of a list's groups: plant and count. */
void eco_wire_group_code(struct eco_range *range, struct eco_wire_items *items, uint32_t i,
	struct eco_group *group);
void eco_wire_colour_code(struct eco_range *range, uint8_t colour[3]);
/* The list's palette is the last one that was sent; if not, it is from now on. */
bool eco_wire_same_palette(struct eco_wire_items *items, const struct eco_list *list);
/* Reading: how many bits there may still be; 0: more was read than there is. An item or a group takes at
 * least one of them, an anchor 4, a colour 24, so that what is read is in proportion to the bytes. */
uint64_t eco_wire_items_bits(const struct eco_range *range);
