/* Options from a file and from the environment, under the names that they have on the command line.
 *
 * Lines of the file are "name = value", or "name" of a flag; '#' begins a comment, and "pack = VALUE", where
 * "pack" is what the caller calls them, is an argument without an option. A file names no other one (config). The environment has PREFIX and the
 * name in capitals with '_' for '-': ECOSERVE_PLAN_WORK=5; of a flag "1", "yes" or "on", or "0", "no", "off"
 * or nothing.
 *
 * All become arguments in front of those that the program was started with, the file's before the
 * environment's, so that what is said later holds. */
#ifndef ECO_OPTIONS_FILE_H
#define ECO_OPTIONS_FILE_H

#include "ecofiles/base/options.h"

struct eco_settings {
	const char *file;                /* NULL: none */
	const char *prefix;              /* of the environment: "ECOSERVE_" */
	const char *input;               /* what an argument without an option is called in the file */
};

/* `items` may be moved about, as eco_command_read does; what they point to, which `owned` has in its order, lives
 * until they are freed. */
struct eco_arguments { char **items, **owned; int count; };

/* All of them: file, environment, argv. ECO_BAD_USAGE names file and line, or the variable: `owned` has what
 * was read before then. The caller frees them in any case. */
enum eco_code eco_settings_read(const struct eco_command *command, const struct eco_settings *settings,
	int argc, char **argv, struct eco_arguments *arguments, struct eco_error *error);
void eco_arguments_free(struct eco_arguments *arguments);

#endif
