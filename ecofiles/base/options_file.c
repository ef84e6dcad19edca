#include "ecofiles/base/options_file.h"

#include <ctype.h>
#include <errno.h>
#include <fcntl.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "ecofiles/base/array_grow.h"

#define LINE_BYTES 4096
#define SETTINGS_OPTION "config"         /* which file it is, is known before it is read */

struct adding { struct eco_arguments *to; uint32_t capacity; };

static bool add_text(struct adding *adding, char *text)
{
	uint32_t count = (uint32_t)adding->to->count;
	if (!text || !eco_array_grow(&adding->to->owned, &adding->capacity, count + 1, sizeof *adding->to->owned)) {
		free(text);
		return false;
	}
	adding->to->owned[count] = text;
	adding->to->owned[++adding->to->count] = NULL;
	return true;
}

/* "--name=value", or "--name" where value is NULL. */
static enum eco_code add_option(struct adding *adding, const char *name, const char *value,
	struct eco_error *error)
{
	char *text = NULL;
	int size = value ? asprintf(&text, "--%s=%s", name, value) : asprintf(&text, "--%s", name);
	return size >= 0 && add_text(adding, text) ? ECO_OK
		: eco_fail(error, ECO_NO_MEMORY, "no memory for arguments");
}

static const struct eco_option *find(const struct eco_command *command, const char *name)
{
	for (const struct eco_option *o = command->options; o->name || o->help; o++)
		if (o->kind < ECO_OPTION_INPUT && o->kind != ECO_OPTION_HEADING && strcmp(o->name, name) == 0)
			return o;
	return NULL;
}

/* ---- The file ---- */

static char *trim(char *text)
{
	text += strspn(text, " \t");
	size_t size = strlen(text);
	while (size && strchr(" \t\r\n", text[size - 1]))
		text[--size] = 0;
	return text;
}

/* The beginning of the comment of a line, or its end. */
static char *find_comment(char *line)
{
	bool quoted = false, space = true;
	for (; *line && !(*line == '#' && space && !quoted); line++) {
		quoted ^= *line == '"';
		space = strchr(" \t", *line);
	}
	return line;
}

/* `value` may be in quotes, which have no escapes. */
static enum eco_code unquote(char **value, const char *where, struct eco_error *error)
{
	size_t size = strlen(*value);
	if (**value != '"')
		return ECO_OK;
	if (size < 2 || strchr(*value + 1, '"') != *value + size - 1)
		return eco_fail(error, ECO_BAD_USAGE, "%s: a value in quotes ends with the second one", where);
	(*value)[size - 1] = 0;
	++*value;
	return ECO_OK;
}

static enum eco_code cut_comment(char *line, const char *where, struct eco_error *error)
{
	char *comment = find_comment(line);
	bool is_clear = comment == line + strspn(line, " \t") || !*comment || strchr(" \t\r\n#", comment[1]);
	*comment = 0;
	return is_clear ? ECO_OK : eco_fail(error, ECO_BAD_USAGE, "%s: a comment begins with '#' and a space; "
		"a value that has '#' behind a space stands in double quotes", where);
}

/* At this point only the file's options are there. */
static bool is_there(const struct adding *adding, const struct eco_option *option, const char *value)
{
	char key[LINE_BYTES + 8];
	const char *equals = value && option->times == ECO_ONCE_A_NAME ? strchr(value, '=') : NULL;
	size_t size = (size_t)snprintf(key, sizeof key, "--%s%s", option->name, value ? "=" : ""),
		name = equals ? (size_t)(equals + 1 - value) : 0;
	if (option->times == ECO_OFTEN)
		return false;
	snprintf(key + size, sizeof key - size, "%.*s", (int)name, value ? value : "");
	for (int i = 0; i < adding->to->count; i++) {
		const char *other = adding->to->owned[i];
		bool same = strncmp(other, key, size + name) == 0;
		if (same && (option->times == ECO_ONCE || name || !strchr(other + size, '=')))
			return true;
	}
	return false;
}

/* A line without its comment; `where` is for messages. */
static enum eco_code add_line(struct adding *adding, const struct eco_command *command, const char *input,
	char *line, const char *where, struct eco_error *error)
{
	char *equals = strchr(line, '='), *value = NULL;
	if (equals) {
		*equals = 0;
		value = trim(equals + 1);
	}
	char *name = trim(line);
	const struct eco_option *option = find(command, name);
	if (!*name && !value)
		return ECO_OK;
	if (value && unquote(&value, where, error))
		return ECO_BAD_USAGE;
	if (value && strcmp(name, input) == 0 && !*value)
		return eco_fail(error, ECO_BAD_USAGE, "%s: '%s =' names nothing", where, name);
	if (value && strcmp(name, input) == 0)
		return add_text(adding, strdup(value)) ? ECO_OK
			: eco_fail(error, ECO_NO_MEMORY, "no memory for arguments");
	if (!option)
		return eco_fail(error, ECO_BAD_USAGE,
			"%s: there is no '%.80s'; names are those of the options, "
			"and '%s'",
			where, name, input);
	if (strcmp(name, SETTINGS_OPTION) == 0)
		return eco_fail(error, ECO_BAD_USAGE, "%s: a file of settings names no other one", where);
	if (option->kind == ECO_OPTION_FLAG && value)
		return eco_fail(error, ECO_BAD_USAGE, "%s: '%s' stands alone on its line", where, name);
	if (option->kind != ECO_OPTION_FLAG && !value)
		return eco_fail(error, ECO_BAD_USAGE, "%s: '%s = %s' is meant", where, name, option->word);
	if (is_there(adding, option, value))
		return eco_fail(error, ECO_BAD_USAGE, "%s: '%s' was set before in this file%s: leave one of "
			"them out", where, name, option->times == ECO_ONCE ? "" : ", with this name");
	return add_option(adding, name, value, error);
}

/* fgets stops at the end of a line, of the file or of its room: before that a text ends at a NUL alone. */
static enum eco_code check_line(const char *line, const char *where, bool is_last, struct eco_error *error)
{
	size_t size = strlen(line);
	if (size == LINE_BYTES - 1)
		return eco_fail(error, ECO_TOO_LARGE, "%s is too long", where);
	return is_last || strchr(line, '\n') ? ECO_OK
		: eco_fail(error, ECO_BAD_USAGE, "%s has a NUL: it is not a file of settings", where);
}

/* A pipe may never have an end, nor even a beginning. */
enum eco_code eco_open_regular(FILE **file, const char *path, const char *what, struct eco_error *error)
{
	struct stat about;
	int descriptor = open(path, O_RDONLY | O_NONBLOCK | O_CLOEXEC);
	bool is_file = descriptor >= 0 && fstat(descriptor, &about) == 0 && S_ISREG(about.st_mode);
	*file = is_file ? fdopen(descriptor, "r") : NULL;
	if (*file)
		return ECO_OK;
	enum eco_code code = descriptor < 0 || is_file ? eco_fail_read(error, path, errno)
		: eco_fail(error, ECO_BAD_USAGE, "%s: %s must be read from a regular file", path, what);
	if (descriptor >= 0)
		close(descriptor);
	return code;
}

static enum eco_code add_file(struct adding *adding, const struct eco_command *command, const char *input,
	const char *path, struct eco_error *error)
{
	char line[LINE_BYTES], where[LINE_BYTES];
	FILE *file;
	enum eco_code code = eco_open_regular(&file, path, "settings", error);
	for (uint32_t number = 1; !code && fgets(line, sizeof line, file); number++) {
		snprintf(where, sizeof where, "%.3000s: line %u", path, number);
		code = check_line(line, where, feof(file), error);
		code = code ? code : cut_comment(line, where, error);
		code = code ? code : add_line(adding, command, input, line, where, error);
	}
	if (!code && ferror(file))
		code = eco_fail_read(error, path, errno);
	if (file)
		fclose(file);
	return code;
}

/* ---- The environment ---- */

static bool is_among(const char *value, const char *const words[4])
{
	for (int i = 0; i < 4; i++)
		if (strcasecmp(words[i], value) == 0)
			return true;
	return false;
}

static enum eco_code add_variable(struct adding *adding, const struct eco_option *option,
	const char *variable, const char *value, struct eco_error *error)
{
	static const char *const yes[4] = { "1", "yes", "on", "true" },
				 *const no[4] = { "0", "no", "off", "" };
	if (option->kind != ECO_OPTION_FLAG)
		return add_option(adding, option->name, value, error);
	if (!is_among(value, yes) && !is_among(value, no))
		return eco_fail(error, ECO_BAD_USAGE, "%s=%.80s: must be one of 1, yes, on, 0, no, off",
			variable, value);
	return is_among(value, yes) ? add_option(adding, option->name, NULL, error) : ECO_OK;
}

static enum eco_code add_environment(struct adding *adding, const struct eco_command *command,
	const char *prefix, struct eco_error *error)
{
	enum eco_code code = ECO_OK;
	for (const struct eco_option *o = command->options; !code && (o->name || o->help); o++) {
		char variable[128];
		if (o->kind >= ECO_OPTION_INPUT || o->kind == ECO_OPTION_HEADING)
			continue;
		snprintf(variable, sizeof variable, "%s%s", prefix, o->name);
		for (char *at = variable; *at; at++)
			*at = *at == '-' ? '_' : (char)toupper((unsigned char)*at);
		const char *value = getenv(variable);
		code = value ? add_variable(adding, o, variable, value, error) : ECO_OK;
	}
	return code;
}

enum eco_code eco_settings_read(const struct eco_command *command, const struct eco_settings *settings,
	int argc, char **argv, struct eco_arguments *arguments, struct eco_error *error)
{
	struct adding adding = { arguments, 0 };
	*arguments = (struct eco_arguments){ 0 };
	enum eco_code code =
		settings->file ? add_file(&adding, command, settings->input, settings->file, error) : ECO_OK;
	code = code ? code : add_environment(&adding, command, settings->prefix, error);
	for (int i = 0; i < argc && !code; i++)
		if (!add_text(&adding, strdup(argv[i])))
			code = eco_fail(error, ECO_NO_MEMORY, "no memory for arguments");
	size_t size = ((size_t)arguments->count + 1) * sizeof *arguments->items;
	if (!code && !(arguments->items = calloc(1, size)))
		code = eco_fail(error, ECO_NO_MEMORY, "no memory for arguments");
	if (!code && arguments->count)
		memcpy(arguments->items, arguments->owned, size);
	return code;
}

void eco_arguments_free(struct eco_arguments *arguments)
{
	for (int i = 0; i < arguments->count; i++)
		free(arguments->owned[i]);
	free(arguments->owned);
	free(arguments->items);
	*arguments = (struct eco_arguments){ 0 };
}
