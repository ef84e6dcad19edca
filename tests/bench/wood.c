/* wood MODEL ...: the share of their wood that plants show, by the forms that their cells draw
 * (tests/support/wood_cover.h). Exit 1 where a mix of cells or a level has a hole, or a level loses more than
 * 2 % of the wood. Lines alone have no bound: from above a line does not show the foot of a trunk, and a pot
 * is no line. */
#include <stdio.h>

#include "ecofiles/import/model/model_import.h"
#include "tests/support/wood_cover.h"

#define MIXES 16u

static bool holds(const struct wood_cover *cover)
{
	bool good = cover->hole <= 0.001 && cover->torn <= 0.02;
	for (uint32_t state = 1; state < WOOD_STATES; state++)
		good = good && cover->same[state] >= 0.98;
	return good;
}

static enum eco_code measure(const char *path, bool *good, struct eco_error *error)
{
	struct eco_model model;
	struct lod_plant plant;
	struct wood_cover cover;
	enum eco_code code = eco_model_import(&model, &(struct eco_model_options){ .paths = &path,
		.path_count = 1 }, error);
	if (code)
		return code;
	code = lod_plant_build(&plant, &model, &(struct lod_plant_options){ .name = "plant", .seed = 1,
		.order = LOD_ORDER_COMBINED }, error);
	if (!code) {
		code = wood_cover_measure(&cover, &plant, &model, MIXES, error);
		lod_plant_free(&plant);
	}
	eco_model_free(&model);
	if (code)
		return code;
	*good = holds(&cover);
	printf("%s: %u cells; all lines %.4f, levels %.4f %.4f %.4f, mixes %.4f, holes %.5f, torn %.4f%s\n",
		path, cover.cells, cover.same[0], cover.same[1], cover.same[2], cover.same[3], cover.mixed,
		cover.hole, cover.torn, *good ? "" : ": FAILED");
	return ECO_OK;
}

int main(int argc, char **argv)
{
	int failed = 0;
	for (int i = 1; i < argc; i++) {
		struct eco_error error = { 0 };
		bool good = false;
		if (measure(argv[i], &good, &error))
			printf("%s: %s\n", argv[i], error.text);
		failed += !good;
		fflush(stdout);
	}
	printf("wood: %d of %d failed\n", failed, argc - 1);
	return failed > 0;
}
