#include "tests/bench/coders/bench_coders_kind.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "ecofiles/format/chunk/chunk_payload.h"

/* As ecofiles/format/chunk/chunk_encode.c: such chunks keep the order of their elements, which no other coder
 * here does; they count as they are stored. */
#define KEPT_FIRST 96u
#define KEPT_MOST 64u
#define TIMES 3

const char *const coders_kind_names[CODERS_KINDS] = { "instances", "summaries", "splats", "points", "lines",
	"leaves", "simple leaves", "wood", "ground" };
const char *const coders_names[CODERS_CODERS] = { "stored", "entropy", "Draco kd", "Draco sequential",
	"meshopt+zstd", "octree", "counts", "in order" };

struct measuring {
	struct coders_figures *figures;
	const struct eco_pack *pack;
	enum coders_kind kind;
	struct coders_entropy *entropy;
	bool good;                   /* all that was decoded is as it was coded */
};

bool coders_kind_has(enum coders_kind kind, const struct eco_list *list)
{
	static const uint8_t kinds[CODERS_KINDS] = { ECO_LIST_INSTANCES, ECO_LIST_POINTS, ECO_LIST_POINTS,
		ECO_LIST_POINTS, ECO_LIST_LINES, ECO_LIST_TRIANGLES, ECO_LIST_TRIANGLES, ECO_LIST_TRIANGLES,
		ECO_LIST_GROUND };
	if (list->kind != kinds[kind])
		return false;
	if (list->kind == ECO_LIST_POINTS)
		return kind == (list->attributes & ECO_ATTR_PLANT ? CODERS_SUMMARIES
			: list->attributes & ECO_ATTR_SPLAT ? CODERS_SPLATS : CODERS_POINTS);
	if (list->kind == ECO_LIST_TRIANGLES)
		return kind == (list->coder == ECO_CODER_MESH ? CODERS_WOOD
			: list->coder == ECO_CODER_FORM ? CODERS_SIMPLE : CODERS_LEAVES);
	return true;
}

/* Whether a coder can take the place of the stored one. Splats lie behind their parents and ground on its
 * grid, so their order must stay; rows of triangles that share corners are no rival of a mesh. */
static bool fits(enum coders_kind kind, enum coders_coder coder)
{
	bool ordered = kind == CODERS_SPLATS || kind == CODERS_GROUND;
	if (coder == CODERS_STORED || coder == CODERS_ENTROPY)
		return kind != CODERS_WOOD || coder == CODERS_STORED;
	if (kind == CODERS_WOOD)
		return coder == CODERS_MESHOPT;
	return coder == CODERS_BY_ORDER ? true : !ordered;
}

static size_t code_by(struct measuring *m, const struct coders_set *set, enum coders_coder coder,
	double *bits, double *ns)
{
	switch (coder) {
	case CODERS_KD:
		return coders_known_draco_kd(set, ns);
	case CODERS_SEQUENTIAL:
		return coders_known_draco_sequential(set, ns);
	case CODERS_MESHOPT:
		return m->kind == CODERS_WOOD ? coders_known_mesh(set, ns) : coders_known_meshopt(set, ns);
	case CODERS_BY_OCTREE:
		return coders_own(set, CODERS_OCTREE, bits, ns, &m->good);
	case CODERS_BY_COUNTS:
		return coders_own(set, CODERS_COUNTS, bits, ns, &m->good);
	default:
		return coders_own(set, CODERS_ORDERED, bits, ns, &m->good);
	}
}

static void add_parts(const struct eco_list *list, const struct coders_set *set, const double *bits,
	double *parts)
{
	const struct coders_table *t = &set->tables[0];
	for (uint32_t k = 0; k < t->columns - t->known; k++)
		parts[coders_part_of(list, t->corners, k)] += bits[k];
}

/* Where a coder cannot take the rows, they count as stored. */
static void code_chunk(struct measuring *m, const struct eco_list *list, const struct coders_set *set,
	const struct eco_chunk *chunk)
{
	struct coders_figures *f = m->figures;
	double stored = chunk->size_bytes;
	f->parted += set->count == 1 ? chunk->primitive_count : 0;
	for (enum coders_coder c = CODERS_KD; c < CODERS_CODERS; c++) {
		double bits[CODERS_COLUMNS_MAX] = { 0 }, ns = 0;
		if (!fits(m->kind, c))
			continue;
		size_t size = code_by(m, set, c, bits, &ns);
		f->bytes[c] += size == SIZE_MAX ? stored : (double)size;
		f->ns[c] += size == SIZE_MAX ? 0 : ns;
		if (c >= CODERS_BY_COUNTS && set->count == 1)
			add_parts(list, set, bits, f->part[c - CODERS_BY_COUNTS]);
	}
}

static void code_whole(struct measuring *m, const struct coders_set *set, double stored, bool alone,
	const double before[CODERS_CODERS])
{
	struct coders_figures *f = m->figures;
	f->whole[CODERS_STORED] += stored;
	for (enum coders_coder c = CODERS_KD; c < CODERS_CODERS; c++) {
		double ns;
		if (!fits(m->kind, c))
			continue;
		/* a list of one chunk is coded already */
		size_t size = alone ? 0 : code_by(m, set, c, NULL, &ns);
		f->whole[c] += alone ? f->bytes[c] - before[c] : size == SIZE_MAX ? stored : (double)size;
	}
}

static double decode_ns(const struct eco_list *list, const struct eco_chunk *chunk, uint32_t ordinal,
	const uint8_t *bytes)
{
	double best = INFINITY;
	for (int i = 0; i < TIMES; i++) {
		struct eco_elements elements;
		double before = coders_now_ns();
		if (!eco_chunk_decode(list, chunk, ordinal, bytes, chunk->size_bytes, &elements, NULL))
			eco_elements_free(&elements);
		best = fmin(best, coders_now_ns() - before);
	}
	return best;
}

static bool keeps_order(const struct eco_list *list, uint32_t first, uint32_t count)
{
	return (list->coder == ECO_CODER_ELEMENTS || list->coder == ECO_CODER_FORM) && first < KEPT_FIRST
		&& count <= KEPT_MOST;
}

static bool add_entropy(struct measuring *m, const struct eco_list *list, struct coders_set *set)
{
	bool good = true;
	for (uint32_t i = 0; i < set->count && good && fits(m->kind, CODERS_BY_COUNTS); i++)
		good = coders_table_sort(&set->tables[i]);
	/* rows that are too wide to sort stay as they are */
	return coders_entropy_add(m->entropy, list, set) || !good;
}

struct list_at {
	const struct eco_list *list;
	const struct eco_ladder *ladder;
	uint32_t first;              /* elements of the chunks before */
	struct coders_set whole;
};

/* Rows as the coders get them; those of the whole list gather in `at->whole`. */
static enum eco_code take_chunk(struct measuring *m, struct list_at *at, uint32_t chunk, uint32_t ordinal,
	struct coders_set *set, struct eco_error *error)
{
	const struct eco_chunk *record = &m->pack->scene.chunks[chunk];
	enum eco_code code = coders_rows_take(set, at->list, record, ordinal, m->pack->map + record->offset,
		error);
	if (code)
		return code;
	bool good = coders_set_append(&at->whole, set);
	if (good && m->kind == CODERS_SPLATS)
		good = at->ladder && coders_splat_rows(set, &at->whole, at->ladder, at->first);
	if (good && m->kind == CODERS_GROUND)
		good = coders_ground_rows(set, at->list->columns);
	return good ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "no memory for rows of %s",
		coders_kind_names[m->kind]);
}

static enum eco_code measure_chunk(struct measuring *m, struct list_at *at, uint32_t chunk, uint32_t ordinal,
	struct eco_error *error)
{
	struct coders_figures *f = m->figures;
	const struct eco_chunk *c = &m->pack->scene.chunks[chunk];
	struct coders_set set = { .count = 0 };
	enum eco_code code = take_chunk(m, at, chunk, ordinal, &set, error);
	double stored = c->size_bytes;
	f->chunks++;
	f->bytes[CODERS_STORED] += stored;
	f->ns[CODERS_STORED] += decode_ns(at->list, c, ordinal, m->pack->map + c->offset);
	if (!code && keeps_order(at->list, at->first, c->element_count)) {
		for (enum coders_coder k = CODERS_KD; k < CODERS_CODERS; k++)
			f->bytes[k] += fits(m->kind, k) ? stored : 0;
	} else if (!code)
		code_chunk(m, at->list, &set, c);
	if (!code && !add_entropy(m, at->list, &set))
		code = eco_fail(error, ECO_NO_MEMORY, "no memory for figures");
	at->first += c->element_count;
	coders_set_free(&set);
	return code;
}

static enum eco_code measure_list(struct measuring *m, uint32_t id, struct eco_error *error)
{
	const struct eco_list *list = &m->pack->scene.lists[id];
	struct coders_figures *f = m->figures;
	struct list_at at = { .list = list, .ladder = coders_splat_ladder(&m->pack->scene, id) };
	double before[CODERS_CODERS];
	enum eco_code code = ECO_OK;
	memcpy(before, f->bytes, sizeof before);
	for (uint32_t c = 0; c < list->chunk_count && !code; c++)
		code = measure_chunk(m, &at, list->chunk_first + c, c, error);
	/* what a parent tells is the same in one chunk */
	if (!code && m->kind != CODERS_SPLATS && m->kind != CODERS_GROUND)
		code_whole(m, &at.whole, f->bytes[CODERS_STORED] - before[CODERS_STORED],
			list->chunk_count == 1, before);
	f->primitives += list->primitive_count;
	coders_set_free(&at.whole);
	return code;
}

static void finish(struct measuring *m)
{
	struct coders_figures *f = m->figures;
	coders_entropy_bits(m->entropy, f->entropy);
	for (enum coders_part p = 0; p < CODERS_PARTS; p++)
		f->bytes[CODERS_ENTROPY] += f->entropy[p] / 8;
	for (enum coders_coder c = 0; c < CODERS_CODERS; c++) {
		if (!fits(m->kind, c))
			f->bytes[c] = f->ns[c] = NAN;
		if (!fits(m->kind, c) || c == CODERS_ENTROPY || f->whole[c] <= 0)
			f->whole[c] = NAN;
	}
	f->ns[CODERS_ENTROPY] = NAN;
}

enum eco_code coders_kind_measure(struct coders_figures *figures, const struct eco_pack *pack,
	enum coders_kind kind, uint32_t step, struct eco_error *error)
{
	struct measuring m = { figures, pack, kind, calloc(1, sizeof *m.entropy), true };
	enum eco_code code = m.entropy ? ECO_OK : eco_fail(error, ECO_NO_MEMORY, "no memory for figures");
	uint32_t seen = 0;
	*figures = (struct coders_figures){ .chunks = 0 };
	for (uint32_t i = 0; i < pack->scene.list_count && !code; i++)
		if (coders_kind_has(kind, &pack->scene.lists[i]) && seen++ % step == 0)
			code = measure_list(&m, i, error);
	if (!code && !m.good)
		code = eco_fail(error, ECO_DAMAGED, "%s: a coder of the bench does not give back what it was "
			"given", coders_kind_names[kind]);
	if (!code)
		finish(&m);
	if (m.entropy)
		coders_entropy_free(m.entropy);
	free(m.entropy);
	return code;
}
