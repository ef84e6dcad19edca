#include "client-min/draw/view_forms.h"

#include <stdlib.h>
#include <string.h>

#include "ecofiles/base/array_grow.h"

#define BAD(...) eco_fail(error, ECO_DAMAGED, __VA_ARGS__)

void view_forms_free(struct view_forms *forms)
{
	view_table_free(&forms->table);
	free(forms->rows);
	*forms = (struct view_forms){ 0 };
}

/* As both are described. */
static enum eco_code check_form(const struct view_list *form, const struct view_list *of,
	struct eco_error *error)
{
	if (of->list.kind != ECO_LIST_TRIANGLES || of->list.coder != ECO_CODER_ELEMENTS)
		return BAD("list %u is a form of list %u, which is not one of fans", form->id, of->id);
	if (form->list.chunk_count != of->list.chunk_count
		|| form->list.element_count != of->list.element_count)
		return BAD("list %u is a form of list %u: %u elements in %u chunks for %u in %u", form->id,
			of->id, form->list.element_count, form->list.chunk_count, of->list.element_count,
			of->list.chunk_count);
	return ECO_OK;
}

/* Up to the end of a chunk, of which one is held and one (`list`) is about to be. */
static enum eco_code check_chunk(const struct view_list *list, uint32_t ordinal, uint32_t elements,
	const struct view_list *other, struct eco_error *error)
{
	if (ordinal < other->chunk_count && elements != other->marks[ordinal].elements)
		return BAD("chunk %u of list %u ends at element %u, that of list %u at %u: they are forms of "
			"the same", ordinal, list->id, elements, other->id, other->marks[ordinal].elements);
	return ECO_OK;
}

static const struct view_list *form_of(const struct view_cache *cache, const struct view_list *list)
{
	return list->list.coder == ECO_CODER_FORM ? view_cache_find(cache, list->list.partner) : NULL;
}

/* The row of a list that has forms, or NULL. */
static uint32_t *row_of(const struct view_forms *forms, uint32_t list)
{
	uint32_t index = view_table_get(&forms->table, list);
	return index == UINT32_MAX ? NULL : forms->rows[index];
}

static uint32_t *row_make(struct view_forms *forms, uint32_t list)
{
	uint32_t *row = row_of(forms, list);
	if (row || !eco_array_grow(&forms->rows, &forms->room, forms->count, sizeof *forms->rows)
			|| !view_table_put(&forms->table, list, forms->count))
		return row;
	return memset(forms->rows[forms->count++], 0xff, sizeof *forms->rows);
}

static enum eco_code enter(struct view_forms *forms, const struct view_list *list, struct eco_error *error)
{
	uint32_t *row = row_make(forms, list->list.partner);
	if (!row)
		return eco_fail(error, ECO_NO_MEMORY, "no memory for a list");
	for (uint32_t i = 0; i < VIEW_FORMS_MAX; i++)
		if (row[i] == list->id || row[i] == UINT32_MAX) {
			row[i] = list->id;
			return ECO_OK;
		}
	return BAD("list %u has more than %u forms", list->list.partner, VIEW_FORMS_MAX);
}

enum eco_code view_forms_bind(struct view_forms *forms, const struct view_cache *cache,
	const struct view_list *list,
	struct eco_error *error)
{
	const struct view_list *of = form_of(cache, list);
	const uint32_t *row = row_of(forms, list->id);
	enum eco_code code = of ? check_form(list, of, error) : ECO_OK;
	for (uint32_t i = 0; row && i < VIEW_FORMS_MAX && !code; i++) {
		const struct view_list *form = view_cache_find(cache, row[i]);
		code = form ? check_form(form, list, error) : ECO_OK;
	}
	return code || list->list.coder != ECO_CODER_FORM ? code : enter(forms, list, error);
}

enum eco_code view_forms_check(const struct view_forms *forms, const struct view_cache *cache,
	const struct view_list *list, uint32_t ordinal, uint32_t elements, struct eco_error *error)
{
	const struct view_list *of = form_of(cache, list);
	const uint32_t *row = row_of(forms, list->id);
	enum eco_code code = of ? check_chunk(list, ordinal, elements, of, error) : ECO_OK;
	for (uint32_t i = 0; row && i < VIEW_FORMS_MAX && !code; i++) {
		const struct view_list *form = view_cache_find(cache, row[i]);
		code = form ? check_chunk(list, ordinal, elements, form, error) : ECO_OK;
	}
	return code;
}
