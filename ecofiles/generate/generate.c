/* The list of example scenes, their folders, and the call of each layout. */
#include "ecofiles/generate/generate.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "ecofiles/generate/generate_plants.h"
#include "ecofiles/generate/generate_scenes.h"

const struct eco_generate_kind eco_generate_kinds[] = {
	{ "park", "trees along a path, groups of conifers, palms, shrubs, grasses and flowers on a gentle "
		"lawn", 60 },
	{ "forest", "a mixed stand on hills: stems with trunk diameters in a CSV file, shrubs and ferns "
		"below", 2000 },
	{ "meadow", "grasses and patches of flowers from nested eco files, with a few trees", 4000 },
	{ "grove", "trees of six kinds on gentle hills, along a ride that the camera walks", 640 },
	{ "palms", "a palm grove", 1500 },
	{ "sunflowers", "a field of sunflowers around an old tree", 13001 },
	{ "outdoor", "groups of trees, shrubs and patches of grasses and flowers on hills", 40000 },
	{ "billion", "a forest of any size: hectares of a thousand plants in blocks of blocks", 1000000000 },
	{ "city", "trees of alpha-cut cards along the streets of a grid", 4000 },
	{ NULL, NULL, 0 },
};
static void (*const layouts[])(struct gen_layout *) =
	{ gen_park, gen_forest, gen_meadow, gen_grove, gen_palms, gen_sunflowers, gen_outdoor, gen_billion,
	gen_city };

static enum eco_code make_folder(const char *path, struct eco_error *error)
{
	struct stat status;
	if (mkdir(path, 0777) == 0)
		return ECO_OK;
	if (errno == EEXIST && stat(path, &status) == 0 && S_ISDIR(status.st_mode))
		return ECO_OK;
	int reason = errno == EEXIST ? ENOTDIR : errno;
	return eco_fail(error, ECO_IO, "%.330s: cannot make this folder: %s%s", path, strerror(reason),
		eco_advice_write(reason));
}

enum eco_code eco_generate(const struct eco_generate_options *options, struct eco_error *error)
{
	size_t kind = 0;
	char models[4096];
	while (eco_generate_kinds[kind].name && strcmp(eco_generate_kinds[kind].name, options->name) != 0)
		kind++;
	if (!eco_generate_kinds[kind].name)
		return eco_fail(error, ECO_BAD_USAGE, "no scene is called %s: generate park, forest, "
			"meadow, grove, palms, sunflowers, outdoor, billion or city", options->name);
	uint64_t most = eco_generate_kinds[kind].plants > ECO_GENERATE_NAMED_MAX ? ECO_GENERATE_PLANTS_MAX
		: ECO_GENERATE_NAMED_MAX;
	if (options->plants > most)
		return eco_fail(error, ECO_TOO_LARGE, "%llu plants: at most %llu are generated; nest eco "
			"files for more", (unsigned long long)options->plants, (unsigned long long)most);
	if (!(options->detail >= 0 && options->detail <= ECO_GENERATE_DETAIL_MAX))
		return eco_fail(error, ECO_TOO_LARGE, "detail %g: 0.1 to %g times the leaves",
			options->detail, ECO_GENERATE_DETAIL_MAX);
	if (snprintf(models, sizeof models, "%s/models", options->folder) >= (int)sizeof models)
		return eco_fail(error, ECO_BAD_INPUT, "%s: path too long", options->folder);
	enum eco_code code = make_folder(options->folder, error);
	if (!code)
		code = make_folder(models, error);
	if (code)
		return code;
	struct gen_layout layout = { .options = options,
		.plants = (uint32_t)(options->plants ? options->plants : eco_generate_kinds[kind].plants),
		.random = { options->seed * 0x9E3779B97F4A7C15u + kind }, .error = error };
	layouts[kind](&layout);
	return layout.code;
}
