/* The commands of ecopack. Each states its usage and its options; the longer ones have files of their own,
 * NAME_command.c and the like. */
#pragma once

#include "ecofiles/base/options.h"

struct main_command {
	struct eco_command line;             /* "ecopack NAME" and its options */
	/* what follows the command's name */
	enum eco_code (*run)(int argc, char **argv, struct eco_error *error);
};

extern const struct main_command main_command_make, main_command_info, main_command_verify,
	main_command_generate, main_command_model, main_command_map, main_command_camera,
	main_command_link, main_command_start, main_command_export, main_command_publish;

extern const struct eco_option main_common[];        /* --quiet, of all commands */

/* eco_command_read, and what --quiet asks for. */
enum eco_code main_read(const struct main_command *command, int argc, char **argv, struct eco_error *error);

extern bool main_is_quiet;
