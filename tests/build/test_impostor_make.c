/* Impostors of plants: what they keep of a model. */
#include "lod/build/impostor/impostor_make.h"
#include "tests/support/plant_models.h"
#include "tests/support/unit_test.h"

static void make(struct lod_impostors *impostors, const struct eco_model *model,
	const struct lod_impostors_options *options)
{
	assert_good(lod_impostors_make(impostors, model, options, &cause));
}

static void write_all(struct eco_writer *w, const struct lod_impostors *impostors)
{
	eco_impostor_body_write(w, &impostors->body);
	for (uint32_t i = 0; i < impostors->level_count; i++)
		assert_good(eco_impostor_level_write(w, &impostors->body, &impostors->levels[i], NULL, &cause));
}

static bool stop(void *ctx, double share)
{
	return ++*(int *)ctx < 3 && share <= 1;
}

UNIT_TEST(it_stops_when_asked)
{
	FREED(soup) soup;
	struct lod_impostors impostors;
	int calls = 0;
	soup_tree(&soup, 20, 0, false);
	assert_code(lod_impostors_make(&impostors, &soup.model,
		&(struct lod_impostors_options){ .progress = stop, .ctx = &calls }, &cause), ECO_INTERRUPTED,
		"");
	assert_int_equal(impostors.level_count, 0);
}

UNIT_TEST(plants_without_extent_have_impostors_too)
{
	struct soup soup;
	struct lod_impostors impostors;
	const struct eco_model nothing = { 0 };
	make(&impostors, &nothing, &(struct lod_impostors_options){ .levels = 0 });
	assert_int_equal(impostors.level_count, 0);
	for (int flat = 0; flat < 3; flat++) {
		soup_begin(&soup);
		soup_quad(&soup, soup_material(&soup, 9, 99, 9, ECO_NONE, false), (struct lod_v3){ 0, 0, 1 },
			(struct lod_v3){ flat == 0, flat == 1, flat == 2 },
			(struct lod_v3){ flat == 1, flat == 2, flat == 0 });
		make(&impostors, &soup.model, &(struct lod_impostors_options){ .levels = 2 });
		assert_int_equal(impostors.level_count, 2);
		assert_true(eco_impostor_body_good(&impostors.body));
		FREED(eco_writer) w = { 0 };
		write_all(&w, &impostors);
		struct eco_impostor_level back;
		struct eco_impostor_body body;
		assert_code(eco_impostor_level_read(&back, &body,
			w.bytes + ECO_IMPOSTOR_BODY_BYTES, w.size, &cause), ECO_DAMAGED, "");
		lod_impostors_free(&impostors);
		soup_free(&soup);
	}
}
