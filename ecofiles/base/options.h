/* Command lines of all programs. One table says what is read, checked and stored, and what --help prints.
 *
 *	static struct { const char *scene, *pack; uint64_t jobs; } given;
 *	static const struct eco_option options[] = {
 *		{ "the scene file", 0, ECO_OPTION_INPUT, "SCENE.json", &given.scene, .is_required = true },
 *		{ "output", 'o', ECO_OPTION_TEXT, "OUT.eco", &given.pack, .is_required = true },
 *		{ "jobs", 0, ECO_OPTION_COUNT, "N", &given.jobs, 1, 64, .help = "threads" }, { 0 } };
 *	static const struct eco_command command = { "program", "SCENE.json -o OUT.eco [--jobs N]",
 *		"Packs a scene.", options };
 *
 *	if (eco_command_answers(&command, argc - 1, argv + 1))      // --help or --version was printed
 *		return eco_command_end(&command, ECO_OK, &error);
 *	code = eco_command_read(&command, argc - 1, argv + 1, &error);
 *	...
 *	return eco_command_end(&command, code, &error);
 *
 * Read as --name VALUE, --name=VALUE, -l VALUE, -lVALUE. Options may stand anywhere; after -- there are none.
 * The last one given holds. */
#pragma once

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>

#include "ecofiles/base/status.h"

#define ECO_HELP_COLUMNS 100
#define ECO_OPTIONS_MAX 64               /* in a table, with those that all commands of a program have */

enum eco_option_kind {                   /* and what `value` points to */
	ECO_OPTION_HEADING,              /* no option: `help` heads those that follow */
	ECO_OPTION_FLAG,                 /* bool */
	ECO_OPTION_TEXT,                 /* const char * */
	ECO_OPTION_COUNT,                /* uint64_t from `low` to `high`; INT64_MAX at most */
	ECO_OPTION_BYTES,                /* as ECO_OPTION_COUNT, with suffixes of 1024 */
	ECO_OPTION_NUMBER,               /* double from `low` to `high` */
	ECO_OPTION_NUMBERS,              /* double[count], each from `low` to `high`, separated by commas */
	ECO_OPTION_SIZE,                 /* uint32_t[2], WIDTHxHEIGHT, each from `low` to `high` */
	ECO_OPTION_CHOICE,               /* int: which of `choices` it is */
	ECO_OPTION_READ,                 /* anything: `read` stores it */
	ECO_OPTION_INPUT,                /* const char *: the argument that no option takes */
	/* struct eco_inputs: all such arguments, at most `high` if that is not 0 */
	ECO_OPTION_INPUTS
};

/* Reads digits and perhaps a suffix: k, M or G, which is 1000, 1000^2 or 1000^3, in ECO_OPTION_BYTES 1024,
 * 1024^2 or 1024^3. *end is what follows. False: there is no digit, or the number exceeds INT64_MAX. */
bool eco_count_read(const char *text, enum eco_option_kind kind, uint64_t *value, const char **end);

/* How often a file of settings may give an option: the last would hold, and nobody would be told. */
enum eco_option_times {
	ECO_ONCE,
	ECO_ONCE_A_NAME,                 /* values are "NAME=VALUE", or "VALUE" for the name "" */
	ECO_OFTEN                        /* all hold */
};

struct eco_inputs { char **names; uint32_t count; };       /* in argv */

struct eco_option {
	/* without its dashes; of inputs, what messages call them ("the scene file") */
	const char *name;
	char letter;                     /* 0: none */
	enum eco_option_kind kind;
	const char *word;                /* for its value, in --help and in messages; NULL of flags */
	void *value;                     /* left alone where the option is not given */
	double low, high;
	/* wrapped where it is printed; NULL: as words/help.tsv says, or of inputs that the synopsis explains */
	const char *help;
	uint32_t count;
	const char *const *choices;      /* ends with NULL */
	/* Stores `text` in `value`; ECO_BAD_USAGE says why not. `text` is NULL where an optional value is
	 * left out. */
	enum eco_code (*read)(const char *text, void *value, struct eco_error *error);
	bool *given;                     /* set if the option is given; may be NULL */
	enum eco_option_times times;
	bool is_required, has_optional_value;    /* --name or --name=VALUE; only of ECO_OPTION_READ */
};

struct eco_command {
	const char *name;                /* as it is typed: "ecoserve", "ecopack make" */
	const char *synopsis;            /* what follows the name in the usage */
	const char *says;                /* what it does */
	const struct eco_option *options;        /* ends with a zero */
	const struct eco_option *common;         /* of all commands of a program; may be NULL */
	/* what --help says below the options, a paragraph or lines; may be NULL */
	const char *notes;
	void (*print_more)(FILE *out);   /* after the notes; may be NULL */
};

/* `argv` is what follows the program's or the command's name. Prints what --help or --version asks for and
 * returns true, or returns false. */
bool eco_command_answers(const struct eco_command *command, int argc, char **argv);

void eco_command_help(const struct eco_command *command, FILE *out);

/* Stores what `argv` says. ECO_BAD_USAGE names what does not fit, or the first of what is required and
 * missing. Inputs are moved to the front of argv. */
enum eco_code eco_command_read(const struct eco_command *command, int argc, char **argv,
	struct eco_error *error);

/* Ends a program: says on stderr what failed and, after wrong usage, where help is. Returns the exit status,
 * which is 1 also if something that was printed did not get out. An error without a text was told by whoever
 * met it. */
int eco_command_end(const struct eco_command *command, enum eco_code code, const struct eco_error *error);

/* Prints `text` in lines of at most ECO_HELP_COLUMNS, the first from column `at` on, which is where the
 * cursor is, the others from column `indent` on; a newline in it is one. Ends with a newline. */
void eco_help_wrap(FILE *out, const char *text, unsigned at, unsigned indent);
