#include "ecofiles/base/options.h"

#include <assert.h>
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#include "build/words/help.table"
#include "ecofiles/base/text.h"
#include "ecofiles/base/version.h"

#define HELP_COLUMN_MIN 18u
#define HELP_COLUMN_MAX 28u

/* The program's part of a command's name. */
static int program_length(const struct eco_command *command)
{
	return (int)strcspn(command->name, " ");
}

static bool is_input(const struct eco_option *o)
{
	return o->kind == ECO_OPTION_INPUT || o->kind == ECO_OPTION_INPUTS;
}

/* ---- Values ---- */

/* The factor of k, M or G; 1 if `letter` is none of them. Small m is no suffix, as it is read as metres. */
static uint64_t suffix(char letter, enum eco_option_kind kind)
{
	const uint64_t step = kind == ECO_OPTION_BYTES ? 1024 : 1000;
	return letter == 'k' || letter == 'K' ? step : letter == 'M' ? step * step
		: letter == 'G' ? step * step * step : 1;
}

bool eco_count_read(const char *text, enum eco_option_kind kind, uint64_t *value, const char **end)
{
	char *rest;
	errno = 0;
	int64_t number = strtoll(text, &rest, 10);
	uint64_t factor = suffix(*rest, kind);
	*end = rest + (factor > 1);
	if (text[0] < '0' || text[0] > '9' || errno || (uint64_t)number > INT64_MAX / factor)
		return false;
	*value = (uint64_t)number * factor;
	return true;
}

/* A bound of bytes with the largest suffix that divides it. */
static const char *bound_text(uint64_t bound, enum eco_option_kind kind, char text[32])
{
	static const char letters[] = "KMG";
	int most = kind == ECO_OPTION_BYTES ? 3 : 0, shift = 0;
	while (shift < most && bound >= 1024 && bound % 1024 == 0) {
		bound /= 1024;
		shift++;
	}
	snprintf(text, 32, "%" PRIu64 "%.1s", bound, shift ? &letters[shift - 1] : "");
	return text;
}

static enum eco_code read_count(const struct eco_option *o, const char *text, struct eco_error *error)
{
	uint64_t low = (uint64_t)o->low, high = o->high < 0x1p63 ? (uint64_t)o->high : INT64_MAX, value;
	const char *end;
	char bounds[2][32];
	if (!eco_count_read(text, o->kind, &value, &end) || *end || value < low || value > high)
		return eco_fail(error, ECO_BAD_USAGE, "--%s %.100s: must be a whole number %sfrom %s to %s%s",
			o->name, text, o->kind == ECO_OPTION_BYTES ? "of bytes " : "",
			bound_text(low, o->kind, bounds[0]), bound_text(high, o->kind, bounds[1]),
			high < 1000 ? "" : ", perhaps with k, M or G behind it, as in 64M");
	*(uint64_t *)o->value = value;
	return ECO_OK;
}

static enum eco_code read_numbers(const struct eco_option *o, const char *text, uint32_t count,
	struct eco_error *error)
{
	double *to = o->value;
	const char *rest = text;
	for (uint32_t i = 0; i < count; i++) {
		char *end;
		double number = strtod(rest, &end);
		uint64_t factor = end > rest ? suffix(*end, o->kind) : 1;
		end += factor > 1;
		number *= (double)factor;
		if (end == rest || *end != (i + 1 < count ? ',' : 0)
				|| !(number >= o->low && number <= o->high))
			return eco_fail(error, ECO_BAD_USAGE, "--%s %.100s: must be %u number%s from %g to "
				"%g%s", o->name, text, count, count == 1 ? "" : "s", o->low, o->high,
				count == 1 ? "" : ", separated by commas");
		to[i] = number;
		rest = end + 1;
	}
	return ECO_OK;
}

static enum eco_code read_size(const struct eco_option *o, const char *text, struct eco_error *error)
{
	unsigned w = 0, h = 0;
	int used = 0;
	if (text[0] < '0' || text[0] > '9' || sscanf(text, "%9ux%9u%n", &w, &h, &used) != 2 || text[used]
		|| w < o->low || h < o->low || w > o->high || h > o->high)
		return eco_fail(error, ECO_BAD_USAGE, "--%s %.100s: must be WIDTHxHEIGHT, each from %.0f to "
			"%.0f", o->name, text, o->low, o->high);
	((uint32_t *)o->value)[0] = w;
	((uint32_t *)o->value)[1] = h;
	return ECO_OK;
}

static enum eco_code read_choice(const struct eco_option *o, const char *text, struct eco_error *error)
{
	char known[256] = "";
	for (int i = 0; o->choices[i]; i++) {
		if (strcmp(o->choices[i], text) == 0) {
			*(int *)o->value = i;
			return ECO_OK;
		}
		eco_phrase_add(known, sizeof known, o->choices[i]);
	}
	return eco_fail(error, ECO_BAD_USAGE, "--%s %.100s: must be one of %s", o->name, text, known);
}

static enum eco_code read_value(const struct eco_option *o, const char *text, struct eco_error *error)
{
	if (o->given)
		*o->given = true;
	switch (o->kind) {
	case ECO_OPTION_FLAG:
		*(bool *)o->value = true;
		return ECO_OK;
	case ECO_OPTION_COUNT:
	case ECO_OPTION_BYTES:
		return read_count(o, text, error);
	case ECO_OPTION_NUMBER:
		return read_numbers(o, text, 1, error);
	case ECO_OPTION_NUMBERS:
		return read_numbers(o, text, o->count, error);
	case ECO_OPTION_SIZE:
		return read_size(o, text, error);
	case ECO_OPTION_CHOICE:
		return read_choice(o, text, error);
	case ECO_OPTION_READ:
		return o->read(text, o->value, error);
	default:
		*(const char **)o->value = text;
		return ECO_OK;
	}
}

/* ---- Arguments ---- */

struct reading {
	const struct eco_command *command;
	const struct eco_option *all[ECO_OPTIONS_MAX];
	bool given[ECO_OPTIONS_MAX];
	uint32_t count;
	int argc;
	char **argv;
	uint32_t inputs;                 /* moved to argv[0], argv[1], ... */
	struct eco_error *error;
};

static void gather(struct reading *r, const struct eco_option *table)
{
	for (const struct eco_option *o = table; o && (o->name || o->help) && r->count < ECO_OPTIONS_MAX; o++)
		r->all[r->count++] = o;
}

/* By its letter if `length` is 0; else `name` ends at '=' or at 0. NULL: there is none. */
static const struct eco_option *find(struct reading *r, const char *name, size_t length)
{
	for (uint32_t i = 0; i < r->count; i++) {
		const struct eco_option *o = r->all[i];
		if (o->kind == ECO_OPTION_HEADING || is_input(o))
			continue;
		if (length ? strlen(o->name) == length && strncmp(o->name, name, length) == 0 : o->letter
				&& o->letter == *name) {
			r->given[i] = true;
			return o;
		}
	}
	return NULL;
}

/* The option at argv[*at] and its value, which may be the next argument. */
static enum eco_code read_option(struct reading *r, int *at)
{
	const char *argument = r->argv[*at], *value = NULL;
	bool is_letter = argument[1] != '-';
	const char *name = argument + (is_letter ? 1 : 2);
	size_t length = is_letter ? 1 : strcspn(name, "=");
	const struct eco_option *o = length ? find(r, name, is_letter ? 0 : length) : NULL;
	if (!o)
		return eco_fail(r->error, ECO_BAD_USAGE, "%s has no %.100s", r->command->name, argument);
	if (name[length])
		value = name + length + (is_letter ? 0 : 1);
	if (o->kind == ECO_OPTION_FLAG && value)
		return eco_fail(r->error, ECO_BAD_USAGE, "%.100s: --%s takes no value", argument, o->name);
	if (o->kind == ECO_OPTION_FLAG || o->has_optional_value)
		return read_value(o, value, r->error);
	if (!value && *at + 1 >= r->argc)
		return eco_fail(r->error, ECO_BAD_USAGE, "%.100s: a value must follow it, %s", argument,
			o->word);
	return read_value(o, value ? value : r->argv[++*at], r->error);
}

static enum eco_code read_input(struct reading *r, char *argument)
{
	for (uint32_t i = 0; i < r->count; i++) {
		const struct eco_option *o = r->all[i];
		if (!is_input(o) || (o->kind == ECO_OPTION_INPUT && r->given[i])
				|| (o->high > 0 && r->inputs >= o->high))
			continue;
		r->given[i] = true;
		if (o->kind == ECO_OPTION_INPUT)
			return read_value(o, argument, r->error);
		r->argv[r->inputs++] = argument;
		*(struct eco_inputs *)o->value = (struct eco_inputs){ r->argv, r->inputs };
		return ECO_OK;
	}
	return eco_fail(r->error, ECO_BAD_USAGE, "%.200s: one argument too many", argument);
}

static enum eco_code check_required(const struct reading *r)
{
	for (uint32_t i = 0; i < r->count; i++) {
		const struct eco_option *o = r->all[i];
		if (!o->is_required || r->given[i])
			continue;
		if (is_input(o))
			return eco_fail(r->error, ECO_BAD_USAGE, "%s is missing: %s", o->name, o->word);
		char letter[] = { '-', o->letter, 0 };
		return eco_fail(r->error, ECO_BAD_USAGE, "%s%s %s is missing", o->letter ? letter : "--",
			o->letter ? "" : o->name, o->word);
	}
	return ECO_OK;
}

enum eco_code eco_command_read(const struct eco_command *command, int argc, char **argv,
	struct eco_error *error)
{
	struct reading r = { .command = command, .argc = argc, .argv = argv, .error = error };
	bool only_inputs = false;
	gather(&r, command->options);
	gather(&r, command->common);
	for (int i = 0; i < argc; i++) {
		enum eco_code code = ECO_OK;
		if (!only_inputs && strcmp(argv[i], "--") == 0)
			only_inputs = true;
		else if (!only_inputs && argv[i][0] == '-' && argv[i][1])
			code = read_option(&r, &i);
		else
			code = read_input(&r, argv[i]);
		if (code)
			return code;
	}
	return check_required(&r);
}

/* ---- Help ---- */

/* A text in brackets is one word. */
static unsigned word_length(const char *text)
{
	size_t length = 0;
	if (*text == '[')
		length = strcspn(text, "]\n");
	return (unsigned)(length + strcspn(text + length, " \n"));
}

void eco_help_wrap(FILE *out, const char *text, unsigned at, unsigned indent)
{
	unsigned column = at, start = at;
	while (*text) {
		unsigned blanks = (unsigned)strspn(text, " "), length = word_length(text + blanks);
		if (column > start && column + blanks + length > ECO_HELP_COLUMNS) {
			column = start = indent;
			fprintf(out, "\n%*s", (int)indent, "");
			text += blanks;
			blanks = 0;
		}
		fprintf(out, "%.*s", (int)(blanks + length), text);
		column += blanks + length;
		text += blanks + length;
		if (*text == '\n' && *++text) {
			column = start = indent;
			fprintf(out, "\n%*s", (int)indent, "");
		}
	}
	fputc('\n', out);
}

/* The option's own text, or that of words/help.tsv for the command or its program; NULL: there is none. */
static const char *help_of(const struct eco_command *command, const struct eco_option *o)
{
	const char *text = o->help;
	for (size_t i = 0; !text && o->name && i < sizeof help_rows / sizeof *help_rows; i++) {
		size_t length = strlen(help_rows[i].command);
		if (strncmp(command->name, help_rows[i].command, length) == 0 && strchr(" ", command->name[length])
				&& strcmp(o->name, help_rows[i].option) == 0)
			text = help_rows[i].text;
	}
	return text;
}

/* Whether a row of the help is an option's or an input's, which is then " -o, --output OUT.eco" or " URL". */
static bool left_of(const struct eco_command *command, const struct eco_option *o, char left[64])
{
	char letter[] = { '-', o->letter, ',', 0 };
	if (o->kind == ECO_OPTION_HEADING)
		return false;
	if (!help_of(command, o)) {
		assert(is_input(o));                 /* words/help.tsv has a row for each option */
		return false;
	}
	if (is_input(o))
		snprintf(left, 64, "  %s", o->word);
	else if (!o->word)
		snprintf(left, 64, "  %-3s --%s", o->letter ? letter : "", o->name);
	else
		snprintf(left, 64, o->has_optional_value ? "  %-3s --%s[=%s]" : "  %-3s --%s %s",
			o->letter ? letter : "", o->name, o->word);
	return true;
}

/* The column in which explanations begin: behind the longest row that leaves room for them. */
static unsigned help_column(const struct eco_command *command, const struct eco_option *table)
{
	char left[64];
	unsigned column = HELP_COLUMN_MIN;
	for (const struct eco_option *o = table; o->name || o->help; o++)
		if (left_of(command, o, left) && strlen(left) + 2 > column && strlen(left) + 2 <= HELP_COLUMN_MAX)
			column = (unsigned)strlen(left) + 2;
	return column;
}

static void print_table(const struct eco_command *command, const struct eco_option *table, unsigned column,
	FILE *out)
{
	char left[64];
	for (const struct eco_option *o = table; o && (o->name || o->help); o++) {
		if (!left_of(command, o, left)) {
			if (o->kind == ECO_OPTION_HEADING)
				fprintf(out, "%s\n", o->help);
			continue;
		}
		if (strlen(left) < column)
			fprintf(out, "%-*s", (int)column, left);
		else
			fprintf(out, "%s\n%*s", left, (int)column, "");
		eco_help_wrap(out, help_of(command, o), column, column);
	}
}

static bool takes_suffixes(const struct eco_option *table)
{
	for (const struct eco_option *o = table; o && (o->name || o->help); o++)
		if (o->kind == ECO_OPTION_COUNT || o->kind == ECO_OPTION_BYTES)
			return true;
	return false;
}

void eco_command_help(const struct eco_command *command, FILE *out)
{
	static const struct eco_option always[] =
		{ { "help", 'h', ECO_OPTION_FLAG, NULL, NULL, .help = "this text" },
		{ "version", 'V', ECO_OPTION_FLAG, NULL, NULL, .help = "the version" }, { 0 } };
	unsigned column = help_column(command, command->options ? command->options : always);
	int at = fprintf(out, "usage: %s ", command->name);
	eco_help_wrap(out, command->synopsis, at > 0 ? (unsigned)at : 0, 8);
	fputc('\n', out);
	eco_help_wrap(out, command->says, 0, 0);
	fputc('\n', out);
	print_table(command, command->options, column, out);
	print_table(command, command->common, column, out);
	print_table(command, always, column, out);
	fputc('\n', out);
	if (command->notes)
		eco_help_wrap(out, command->notes, 0, 0);
	if (command->print_more)
		command->print_more(out);
	if (takes_suffixes(command->options) || takes_suffixes(command->common))
		eco_help_wrap(out,
			"Numbers may end with k, M or G: thousands, millions and billions; in bytes "
			"1024, 1024^2 and 1024^3. 2M vertices are 2000000.",
			0, 0);
	fputs("Exit status: 0 done, 1 failed, 2 wrong usage.\n", out);
}

static bool is_among(int argc, char **argv, const char *name, const char *letter)
{
	for (int i = 0; i < argc && strcmp(argv[i], "--") != 0; i++)
		if (strcmp(argv[i], name) == 0 || strcmp(argv[i], letter) == 0)
			return true;
	return false;
}

bool eco_command_answers(const struct eco_command *command, int argc, char **argv)
{
	if (is_among(argc, argv, "--version", "-V"))
		printf("%.*s " ECO_VERSION "\n", program_length(command), command->name);
	else if (is_among(argc, argv, "--help", "-h"))
		eco_command_help(command, stdout);
	else
		return false;
	return true;
}

int eco_command_end(const struct eco_command *command, enum eco_code code, const struct eco_error *error)
{
	int program = program_length(command);
	if (code && error->text[0])
		fprintf(stderr, "%.*s: %s\n", program, command->name, error->text);
	if (code == ECO_BAD_USAGE)
		fprintf(stderr, "%s --help says how it is used\n", command->name);
	if (fflush(stdout) == 0 && !ferror(stdout))
		return eco_exit_status(code);
	fprintf(stderr, "%.*s: cannot write to stdout\n", program, command->name);
	return code ? eco_exit_status(code) : 1;
}
