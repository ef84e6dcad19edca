/* The commands of ecopack. Each states its usage and its options; the longer ones have files of their own,
 * NAME_command.c and the like. */
#ifndef ECO_MAIN_COMMAND_H
#define ECO_MAIN_COMMAND_H

#include <stdbool.h>
#include <stdint.h>

#include "ecofiles/base/status.h"

struct main_option {
	const char *name;            /* without its dashes; NULL ends the table */
	char letter;                 /* 0: none */
	enum { MAIN_FLAG, MAIN_TEXT, MAIN_COUNT, MAIN_NUMBER, MAIN_NUMBERS } kind;
	void *value;                 /* bool, const char *, uint64_t, double, double[count]; unchanged unless given */
	double low, high;            /* of counts and numbers, inclusive */
	uint32_t count;              /* MAIN_NUMBERS: exactly so many, separated by commas */
	bool *given;                 /* may be NULL */
};

struct main_command {
	const char *name;
	const char *synopsis;        /* the rest of the usage line, behind the name */
	const char *says;            /* a description in one line */
	const char *help;            /* its options, one a line; may be NULL */
	/* arguments after the command's name */
	enum eco_code (*run)(int argc, char **argv, struct eco_error *error);
};

extern const struct main_command main_command_make, main_command_info, main_command_verify, main_command_generate, main_command_model,
	main_command_map, main_command_sheet, main_command_camera, main_command_link;

/* Reads a command's arguments: its `options`, and --quiet, which all have. Other arguments go to `inputs`,
 * one to `most` of them; messages call them `what` ("the scene file"). *count may be NULL if most is 1.
 * Options may stand anywhere, but not after --. ECO_BAD_USAGE names the argument that does not fit. */
enum eco_code main_arguments(int argc, char **argv, const char *command, const struct main_option *options, const char *what,
	const char **inputs, uint32_t most, uint32_t *count, struct eco_error *error);

extern bool main_is_quiet;

#endif
