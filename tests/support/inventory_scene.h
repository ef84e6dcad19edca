/* An inventory read as a scene asks for it: JSON of an entry and a file in, plants and the report out, both
 * as text. */
#ifndef TESTS_INVENTORY_SCENE_H
#define TESTS_INVENTORY_SCENE_H

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "ecofiles/format/model.h"
#include "ecofiles/scene/scene.h"
#include "tests/support/input_files.h"

/* species: what each plant's row states; "": none, "-": no column does. */
struct inventory { char plants[8000], species[8000], report[8000], error[1024]; };

/* `scene`: its fields before "plants", each with its comma; `entry`: fields of the entry, after "from".
 * Plants are oak, ash and elm; elm has three variants. The message of a failure is in `error`, which is empty
 * otherwise. */
const struct inventory *inventory_of(const char *test, const char *scene, const char *file,
	const char *entry);

#endif
