/* The commands of ecopack. Each says its usage and its options; those that are more than a call are files of their own, main_NAME.c. */
#ifndef ECO_MAIN_COMMAND_H
#define ECO_MAIN_COMMAND_H

#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/base/status.h"

struct main_option {
	const char *name;            /* without its dashes; NULL ends the table */
	char letter;                 /* 0: none */
	enum { MAIN_FLAG, MAIN_TEXT, MAIN_COUNT, MAIN_NUMBER, MAIN_NUMBERS } kind;
	void *value;                 /* bool, const char *, uint64_t, double, double[count]; left alone where not given */
	double low, high;            /* of counts and numbers, inclusive */
	uint32_t count;              /* MAIN_NUMBERS: exactly so many, separated by commas */
	bool *given;                 /* may be NULL */
};

struct main_command {
	const char *name;
	const char *synopsis;        /* what follows the name in the usage, one line */
	const char *says;            /* what it does, one line */
	const char *help;            /* its options, a line each; may be NULL */
	/* arguments after the command's name */
	enum eco_code (*run)(int argc, char **argv, struct eco_error *error);
};

extern const struct main_command main_command_make, main_command_info, main_command_verify, main_command_generate, main_command_model,
	main_command_map, main_command_sheet, main_command_camera, main_command_link;

/* Reads what a command was given: `options`, and --quiet for all. What is no option goes to `inputs`, at most `most` of them and at
 * least one, `what` in messages ("the scene file"). *count may be NULL if most is 1. Options may stand anywhere; after -- there are none.
 * ECO_BAD_USAGE names what does not fit. */
enum eco_code main_arguments(int argc, char **argv, const char *command, const struct main_option *options, const char *what,
	const char **inputs, uint32_t most, uint32_t *count, struct eco_error *error);

extern bool main_is_quiet;

#endif
