/* Options from a file and from the environment, under the names that they have on the command line.
 *
 * Lines of the file are "name = value", or "name" of a flag, and "pack = VALUE", where "pack" is what the
 * caller calls them, is an argument without an option. '#' begins a comment at the start of a line, and with
 * a space on both sides; it is part of a value in double quotes, and where no space is before it. An option
 * stands there once, unless its table says otherwise. The file is a regular one and names no other (config).
 *
 * The environment has PREFIX and the name in capitals with '_' for '-': ECOSERVE_PLAN_WORK=5; of a flag
 * "1", "yes" or "on", or "0", "no", "off" or nothing.
 *
 * All become arguments in front of those that the program was started with, the file's before the
 * environment's, so that what is said later holds. */
#pragma once

#include "ecofiles/base/options.h"

struct eco_settings {
	const char *file;                /* NULL: none */
	const char *prefix;              /* of the environment: "ECOSERVE_" */
	const char *input;               /* what an argument without an option is called in the file */
};

/* `items` may be moved about, as eco_command_read does; what they point to, which `owned` has in its order,
 * lives until they are freed. */
struct eco_arguments { char **items, **owned; int count; };

/* All of them: file, environment, argv. ECO_BAD_USAGE names file and line, or the variable: `owned` has what
 * was read before then. The caller frees them in any case. */
enum eco_code eco_settings_read(const struct eco_command *command, const struct eco_settings *settings,
	int argc, char **argv, struct eco_arguments *arguments, struct eco_error *error);
/* Opens a file that an option names, to be read. ECO_BAD_USAGE: it is a pipe, a device or a folder; `what` is
 * for the message. */
enum eco_code eco_open_regular(FILE **file, const char *path, const char *what, struct eco_error *error);
void eco_arguments_free(struct eco_arguments *arguments);
