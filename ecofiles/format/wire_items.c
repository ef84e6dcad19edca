#include "ecofiles/format/wire_items.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

#define MANTISSA 52
#define NAME_MOST 63u

void eco_wire_items_start(struct eco_wire_items *s)
{
	memset(s, 0, sizeof *s);
	/* models come first, up to the first member that is none */
	eco_bits_start((struct eco_bit *)s, offsetof(struct eco_wire_items, kind) / sizeof(struct eco_bit));
	s->plant = s->list = s->chunk_list = s->described = ECO_NONE;
}

uint64_t eco_wire_items_bits(const struct eco_range *r)
{
	/* the coder reads four bytes ahead, and up to 255 zeros are left off */
	uint64_t end = (uint64_t)r->size + 260;
	return r->at < end ? 8 * (end - r->at) : 0;
}

/* ---- Values ---- */

static uint32_t code_number(struct eco_range *r, struct eco_wire_items *s, struct eco_wire_number *n,
	uint32_t value)
{
	uint64_t v = eco_range_size(r, n->models, 6, value);
	s->bad |= v > UINT32_MAX;
	return s->bad ? 0 : (uint32_t)v;
}

static uint32_t code_count(struct eco_range *r, struct eco_wire_items *s, struct eco_wire_number *n,
	uint32_t value)
{
	uint32_t half = code_number(r, s, n, value >> 1);
	s->bad |= half > UINT32_MAX >> 1;
	return half << 1 | (uint32_t)eco_range_raw(r, 1, value & 1);
}

/* A value by its difference to another. */
static uint32_t code_step(struct eco_range *r, struct eco_wire_items *s, struct eco_wire_number *n,
	uint32_t before, uint32_t value)
{
	return before + eco_unzigzag(code_number(r, s, n, eco_zigzag(value - before)));
}

/* ---- Reals ---- */

struct parts { uint32_t sign; int32_t exponent, low; uint64_t mantissa; };

static struct parts parts_of(double v)
{
	uint64_t bits;
	memcpy(&bits, &v, sizeof bits);
	struct parts p = { (uint32_t)(bits >> 63), (int32_t)(bits >> MANTISSA & 2047), 0,
		bits & ((1ull << MANTISSA) - 1) };
	p.low = p.exponent - (p.mantissa ? MANTISSA - __builtin_ctzll(p.mantissa) : 0);
	return p;
}

static double code_parts(struct eco_range *r, struct eco_wire_items *s, struct eco_wire_real *m,
	double before, double value)
{
	struct parts p = parts_of(value), b = parts_of(before);
	p.sign = (uint32_t)eco_range_raw(r, 1, p.sign);
	p.exponent = (int32_t)code_step(r, s, &m->exponent, (uint32_t)b.exponent, (uint32_t)p.exponent);
	p.low = (int32_t)code_step(r, s, &m->low, (uint32_t)b.low, (uint32_t)p.low);
	int64_t bits = (int64_t)p.exponent - p.low;
	s->bad |= p.exponent < 0 || p.exponent > 2047 || bits < 0 || bits > MANTISSA;
	if (s->bad)
		return 0;
	if (bits > 0) {
		int shift = MANTISSA - (int)bits;
		uint64_t high = eco_range_raw(r, (unsigned)bits - 1, p.mantissa >> (shift + 1));
		p.mantissa = high << (shift + 1) | 1ull << shift;
	} else {
		p.mantissa = 0;
	}
	uint64_t all = (uint64_t)p.sign << 63 | (uint64_t)p.exponent << MANTISSA | p.mantissa;
	memcpy(&value, &all, sizeof value);
	return value;
}

static bool same_bits(double a, double b) { return memcmp(&a, &b, sizeof a) == 0; }

static double code_real(struct eco_range *r, struct eco_wire_items *s, struct eco_wire_real *m, double before,
	double value)
{
	if (!eco_range_bit(r, &m->same, !same_bits(value, before)))
		return before;
	value = code_parts(r, s, m, before, value);
	s->bad |= same_bits(value, before);
	return value;
}

static float narrow(struct eco_wire_items *s, double value)
{
	s->bad |= isfinite(value) && fabs(value) > 3.4028234663852886e38;
	float v = s->bad ? 0 : (float)value;
	s->bad |= isfinite(value) && !same_bits((double)v, value);
	return v;
}

/* ---- Plants ---- */

static void code_name(struct eco_range *r, struct eco_wire_items *s, char name[64])
{
	uint32_t size = (uint32_t)strnlen(name, NAME_MOST);
	size = code_number(r, s, &s->letter_count, size);
	s->bad |= size > NAME_MOST;
	for (uint32_t i = 0; i < size && !s->bad; i++)
		name[i] = (char)eco_range_tree(r, s->letters, 8, (uint8_t)name[i]);
	if (!s->bad)
		memset(name + size, 0, 64 - size);
}

static void code_plant(struct eco_range *r, struct eco_wire_items *s, struct eco_wire_item *item)
{
	struct eco_plant *p = &item->plant;
	s->plant = item->id = code_step(r, s, &s->plant_step, s->plant + 1, item->id);
	code_name(r, s, p->name);
	s->last_height = code_real(r, s, &s->height, s->last_height, (double)p->height_m);
	p->height_m = narrow(s, s->last_height);
	p->anchor_first = code_step(r, s, &s->anchor_first, s->anchor_end, p->anchor_first);
	p->anchor_count = code_number(r, s, &s->anchor_count, p->anchor_count);
	s->anchor_end = p->anchor_first + p->anchor_count;
	item->cells = p->anchor_count > 1 && eco_range_bit(r, &s->celled, item->cells);
	p->leaf_width = (uint16_t)eco_range_raw(r, 16, p->leaf_width);
	p->leaf_tone = (uint8_t)eco_range_raw(r, 8, p->leaf_tone);
}

void eco_wire_anchor_code(struct eco_range *r, struct eco_wire_items *s, struct eco_anchor *anchor)
{
	for (int i = 0; i < 4; i++) {
		float *v = i < 3 ? &anchor->center[i] : &anchor->radius;
		s->last_anchor[i] = code_parts(r, s, &s->anchor[i == 3], s->last_anchor[i], (double)*v);
		*v = narrow(s, s->last_anchor[i]);
	}
}

/* ---- Lists ---- */

static uint32_t relative(uint32_t to, uint32_t id)
{
	return to == ECO_NONE ? 0 : eco_zigzag(to - id) + 1;
}

static uint32_t absolute(uint32_t code, uint32_t id) { return code ? id + eco_unzigzag(code - 1) : ECO_NONE; }

static void code_fields(struct eco_range *r, struct eco_wire_items *s, uint32_t kind, uint32_t id,
	struct eco_list *l)
{
	uint32_t level = l->level, image = relative(l->image, id), partner = relative(l->partner, id),
		more = l->primitive_count - l->element_count;
	uint32_t *const fields[ECO_FIELDS] = { [ECO_FIELD_OWNER] = &l->owner,
		[ECO_FIELD_PALETTE_FIRST] = &l->palette_first, [ECO_FIELD_PALETTE_COUNT] = &l->palette_count,
		[ECO_FIELD_LEVEL] = &level, [ECO_FIELD_GROUPS] = &l->group_count, [ECO_FIELD_IMAGE] = &image,
		[ECO_FIELD_PARTNER] = &partner, [ECO_FIELD_COLUMNS] = &l->columns,
		[ECO_FIELD_CHUNKS] = &l->chunk_count, [ECO_FIELD_ELEMENTS] = &l->element_count,
		[ECO_FIELD_MORE] = &more };
	for (int i = 0; i < ECO_FIELDS && !s->bad; i++) {
		uint32_t before = s->field[kind][i], *f = fields[i];
		bool steps = i == ECO_FIELD_OWNER || i == ECO_FIELD_PALETTE_FIRST;
		if (i == ECO_FIELD_ELEMENTS)
			*f = code_count(r, s, &s->fields[kind][i], *f);
		else if (!eco_range_bit(r, &s->same[kind][i], *f != before))
			*f = before;
		else {
			*f = steps ? code_step(r, s, &s->fields[kind][i], before, *f)
				: code_number(r, s, &s->fields[kind][i], *f);
			s->bad |= *f == before;
		}
		s->field[kind][i] = *f;
	}
	s->bad |= level > UINT8_MAX;
	l->level = (uint8_t)level;
	l->image = absolute(image, id);
	l->partner = absolute(partner, id);
	l->primitive_count = l->element_count + more;
}

enum grid_form { GRID_OF_KIND, GRID_OF_LAST, GRID_SENT };

static bool same_grid(const double *a, const double *b) { return !memcmp(a, b, ECO_GRID_REALS * sizeof *a); }

static enum grid_form grid_form(const struct eco_wire_items *s, uint32_t kind, const double *grid)
{
	return same_grid(grid, s->real[kind]) ? GRID_OF_KIND : same_grid(grid, s->last_grid) ? GRID_OF_LAST
		: GRID_SENT;
}

/* `grid`: of the list, where it is written. */
static void code_grid(struct eco_range *r, struct eco_wire_items *s, uint32_t kind,
	double grid[ECO_GRID_REALS])
{
	double *before = s->real[kind];
	uint32_t form = eco_range_tree(r, s->grid[kind], 2, grid_form(s, kind, grid));
	if (form != GRID_SENT)
		memcpy(grid, form == GRID_OF_KIND ? before : s->last_grid, ECO_GRID_REALS * sizeof *grid);
	for (uint32_t i = 0; i < ECO_GRID_REALS && form == GRID_SENT && !s->bad; i++)
		grid[i] = code_real(r, s, &s->reals[kind][i / 3], i > 3 ? grid[i - 1] : before[i], grid[i]);
	s->bad |= form != grid_form(s, kind, grid);
	memcpy(before, grid, ECO_GRID_REALS * sizeof *grid);
	memcpy(s->last_grid, grid, ECO_GRID_REALS * sizeof *grid);
}

static void code_reals(struct eco_range *r, struct eco_wire_items *s, uint32_t kind, struct eco_list *l)
{
	double grid[ECO_GRID_REALS], *area = &s->real[kind][ECO_GRID_REALS];
	memcpy(grid, l->grid_origin, sizeof l->grid_origin);
	memcpy(grid + 3, l->grid_step, sizeof l->grid_step);
	code_grid(r, s, kind, grid);
	memcpy(l->grid_origin, grid, sizeof l->grid_origin);
	memcpy(l->grid_step, grid + 3, sizeof l->grid_step);
	*area = code_real(r, s, &s->reals[kind][2], *area, (double)l->unit_area);
	l->unit_area = narrow(s, *area);
}

static void code_list(struct eco_range *r, struct eco_wire_items *s, struct eco_wire_item *item)
{
	struct eco_list *l = &item->list;
	s->list = s->described = item->id = code_step(r, s, &s->list_step, s->list + 1, item->id);
	uint32_t kind = eco_range_tree(r, s->list_kind[s->list_kind_last], 4, l->kind);
	l->kind = (uint8_t)kind;
	l->coder = (uint8_t)eco_range_tree(r, s->coder[kind], 3, l->coder);
	l->attributes = (uint8_t)eco_range_tree(r, s->attributes[kind], 8, l->attributes);
	code_fields(r, s, kind, item->id, l);
	code_reals(r, s, kind, l);
	s->list_kind_last = (uint8_t)kind;
	s->chunk_list = ECO_NONE;
}

void eco_wire_group_code(struct eco_range *r, struct eco_wire_items *s, uint32_t i, struct eco_group *group)
{
	uint32_t before = i ? s->group + 1 : s->groups_plant;
	s->group = group->plant = code_step(r, s, &s->group_plant, before, group->plant);
	group->count = code_count(r, s, &s->group_count, group->count - 1) + 1;
	if (i == 0)
		s->groups_plant = group->plant;
}

void eco_wire_colour_code(struct eco_range *r, uint8_t colour[3])
{
	for (int i = 0; i < 3; i++)
		colour[i] = (uint8_t)eco_range_raw(r, 8, colour[i]);
}

bool eco_wire_same_palette(struct eco_wire_items *s, const struct eco_list *list)
{
	bool same = s->palette_count == list->palette_count && s->palette_first == list->palette_first;
	s->palette_first = list->palette_first;
	s->palette_count = list->palette_count;
	return same;
}

/* ---- Chunks ---- */

static void code_ordinal(struct eco_range *r, struct eco_wire_items *s, struct eco_wire_item *item)
{
	uint32_t next = s->chunk_list == item->id ? s->chunk_ordinal + 1 : 0;
	if (!eco_range_bit(r, &s->next, item->ordinal != next)) {
		item->ordinal = next;
		return;
	}
	item->ordinal = code_number(r, s, &s->ordinal, item->ordinal);
	s->bad |= item->ordinal == next;
}

static void code_chunk_counts(struct eco_range *r, struct eco_wire_items *s, uint32_t kind,
	struct eco_wire_item *item)
{
	struct eco_chunk *c = &item->chunk;
	uint32_t slot = item->ordinal < ECO_ITEM_ORDINALS ? item->ordinal : ECO_ITEM_ORDINALS - 1,
		*usual = &s->chunk_elements[kind][slot], more = c->primitive_count - c->element_count;
	if (!eco_range_bit(r, &s->alike[kind], c->element_count != *usual))
		c->element_count = *usual;
	else {
		c->element_count = code_count(r, s, &s->elements, c->element_count);
		s->bad |= c->element_count == *usual;
	}
	*usual = c->element_count;
	uint32_t form = more == 0 ? 0 : more == c->element_count ? 1 : 2;
	form = eco_range_tree(r, s->more[kind], 2, form);
	if (form == 2) {
		more = code_number(r, s, &s->extra, more);
		s->bad |= more == 0 || more == c->element_count;
	} else {
		s->bad |= form == 3 || (form == 1 && !c->element_count);
		more = form ? c->element_count : 0;
	}
	s->bad |= more > UINT32_MAX - c->element_count;
	c->primitive_count = c->element_count + more;
}

static void code_chunk(struct eco_range *r, struct eco_wire_items *s, struct eco_wire_item *item)
{
	struct eco_chunk *c = &item->chunk;
	item->id = code_step(r, s, &s->chunk_step, s->list, item->id);
	uint32_t kind = item->id == s->described ? s->list_kind_last : 0;
	if (s->alone && item->id == s->list) {
		item->ordinal = 0;
		c->element_count = s->alone_elements;
		c->primitive_count = s->alone_primitives;
	} else {
		code_ordinal(r, s, item);
		code_chunk_counts(r, s, kind, item);
	}
	item->named = eco_range_bit(r, &s->named, item->named);
	c->size_bytes = code_count(r, s, &s->size[kind], c->size_bytes);
	for (size_t i = 0; item->named && i < sizeof c->id.bytes; i++)
		c->id.bytes[i] = (uint8_t)eco_range_raw(r, 8, c->id.bytes[i]);
	s->list = s->chunk_list = item->id;
	s->chunk_ordinal = item->ordinal;
}

void eco_wire_item_code(struct eco_range *r, struct eco_wire_items *s, struct eco_wire_item *item)
{
	item->kind = (enum eco_wire_item_kind)eco_range_tree(r, s->kinds[s->kind], 2, (uint32_t)item->kind);
	if (item->kind == ECO_ITEM_PLANT)
		code_plant(r, s, item);
	else if (item->kind == ECO_ITEM_LIST)
		code_list(r, s, item);
	else if (item->kind == ECO_ITEM_CHUNK)
		code_chunk(r, s, item);
	s->kind = item->kind;
	s->alone = item->kind == ECO_ITEM_LIST && item->list.chunk_count == 1;
	s->alone_elements = item->list.element_count;
	s->alone_primitives = item->list.primitive_count;
}
